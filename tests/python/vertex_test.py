"""The choice of the vertex, everywhere a dump is filtered: the package gives the bytes and figures of
the commands, studies give what psf filter does, and the renderer's choice is that without one.

    vertex_test.py PACKAGE PROGRAMS SAMPLE_DATA
"""

import json
import os
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import warnings
from typing import Any

from support import CORNELL, PROGRAMS, assert_refused, content, run

import psf

if not os.path.exists(os.path.join(PROGRAMS, "psf-render")):
    print("skipped: built without the renderer")
    sys.exit(77)

RULE = ("--vertex", "depth:1", "--visibility=off")  # visibility belongs to the renderer's vertex


def attribute(rule: str) -> bytes:
    """The attribute as it stands in an EXR: name, type, length, text."""
    return b"psf:vertex\0string\0" + struct.pack("<i", len(rule)) + rule.encode()


def without(figures: Any, *names: str) -> Any:
    """The figures without those of these names, at any depth."""
    if isinstance(figures, dict):
        return {name: without(value, *names) for name, value in figures.items()
                if name not in names}
    return [without(one, *names) for one in figures] if isinstance(figures, list) else figures


class Vertex(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        size = ["--size", "24x24", "--quiet"]
        cls.paths = [cls.file(f"{seed}.pvb") for seed in range(2)]
        for seed, path in enumerate(cls.paths):
            run("psf-render", CORNELL, *size, "--passes", "8", "--seed", str(seed), "--vertices",
                "all", "-o", path)
        cls.reference = cls.file("reference.exr")
        run("psf-render", CORNELL, *size, "--passes", "32", "--seed", "9", "--image", cls.reference)
        cls.dump = psf.open(cls.paths[0])

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    @classmethod
    def file(cls, name: str) -> str:
        return os.path.join(cls.folder.name, name)

    @classmethod
    def figures(cls, name: str) -> Any:
        with open(cls.file(name), encoding="utf-8") as file:
            return json.load(file)

    def test_filter_gives_the_bytes_of_the_command_and_both_say_the_rule(self) -> None:
        said = run("psf", "filter", self.paths[0], *RULE, "-o", self.file("c.exr"), "--json",
                   self.file("c.json"), "--quiet")
        picture = self.dump.filter(vertex="depth:1", visibility=False)
        picture.save(self.file("p.exr"))
        self.assertEqual(content(self.file("p.exr")), content(self.file("c.exr")))
        self.assertEqual(picture.attributes["psf:vertex"], "depth:1")
        self.assertEqual(self.figures("c.json")["vertex"], "depth:1")
        self.assertTrue(re.search(r"^vertex +depth:1$", said, re.MULTILINE), said)
        other = self.dump.filter(visibility=False)
        self.assertNotIn("psf:vertex", other.attributes)
        self.assertFalse((picture.rgb == other.rgb).all())

    def test_a_row_of_a_sweep_is_what_filter_and_compare_give(self) -> None:
        run("psf", "sweep", self.paths[0], *RULE, "--reference", self.reference, "--r0", "2px,6px",
            "--pictures", "-o", self.file("sweep"), "--quiet")
        study = self.figures("sweep/sweep.json")
        self.assertEqual(study["input"]["vertex"], "depth:1")
        rows = self.dump.sweep(self.reference, r0=["2px", "6px"], vertex="depth:1",
                               visibility=False)
        self.assertEqual(len(study["rows"]), 2)
        for row, own in zip(study["rows"], rows):
            picture = self.dump.filter(vertex="depth:1", visibility=False,
                                       r0=row["parameters"]["r0"])
            self.assertAlmostEqual(picture.error(self.reference), row["metrics"]["relMSE"],
                                   delta=1e-5 * row["metrics"]["relMSE"])
            self.assertEqual(own["relMSE"], row["metrics"]["relMSE"])
            self.assertEqual(own["neighbors"], row["neighbors"])
        self.assertIn(attribute("depth:1"), content(self.file("sweep/0001.exr")))
        with self.assertRaises(subprocess.CalledProcessError):  # rows of another vertex do not join these
            run("psf", "sweep", self.paths[0], "--reference", self.reference, "--r0", "3px",
                "--resume", "-o", self.file("sweep"), "--quiet")

    def test_converge_gives_the_files_of_the_command(self) -> None:
        run("psf", "converge", *self.paths, *RULE, "--reference", self.reference, "--r0", "4px",
            "--no-times", "--quiet", "-o", self.file("command"))
        study = psf.converge(self.paths, self.reference, vertex="depth:1", visibility=False,
                             r0="4px", times=False)
        study.save(self.file("same"))
        for name in ("converge.json", "converge.csv"):
            self.assertEqual(content(self.file("same/" + name)),
                             content(self.file("command/" + name)), name)
        self.assertEqual([one["vertex"] for one in study["inputs"]], ["depth:1"] * 2)
        last = [row for row in study.rows if row["n"] == 8][-1]
        errors = [psf.open(path).filter(vertex="depth:1", visibility=False, r0="4px")
                  .error(self.reference) for path in self.paths]
        self.assertAlmostEqual(last["relMSE"], sum(errors) / 2, delta=1e-5 * last["relMSE"])

    def test_what_tune_chose_is_filtered_at_its_vertex(self) -> None:
        run("psf", "tune", self.paths[0], *RULE, "--r0", "2px,8px", "--json", self.file("t.json"))
        tuning = self.dump.tune(vertex="depth:1", visibility=False, r0=["2px", "8px"])
        tuning.save(self.file("same.json"))
        self.assertEqual(content(self.file("same.json")), content(self.file("t.json")))
        self.assertEqual(tuning.best["vertex"], "depth:1")
        run("psf", "filter", self.paths[0], "--tuned", self.file("t.json"), "-o",
            self.file("tuned.exr"), "--quiet")
        self.dump.filter(**tuning.best).save(self.file("best.exr"))
        self.assertEqual(content(self.file("tuned.exr")), content(self.file("best.exr")))
        run("psf", "filter", self.paths[0], "--tuned", self.file("t.json"), "--vertex",
            "first-rough", "-o", self.file("other.exr"), "--quiet")
        self.assertIn(attribute("first-rough"), content(self.file("other.exr")))

    def test_explain_and_ablate_say_what_the_commands_say(self) -> None:
        said = run("psf", "explain", self.paths[0], *RULE, "--pixel", "3,20", "--json",
                   self.file("e.json"))
        explained = self.dump.explain((3, 20), vertex="depth:1", visibility=False)
        self.assertEqual(str(explained), said)
        self.assertEqual(dict(explained), self.figures("e.json"))
        self.assertEqual(explained["vertex"], "depth:1")
        value = self.dump.filter(vertex="depth:1", visibility=False).rgb[20, 3]
        for got, expected in zip(explained["value"]["filtered"], value):
            self.assertAlmostEqual(got, float(expected), delta=1e-5 * abs(float(expected)) + 1e-9)
        run("psf", "ablate", self.paths[0], *RULE, "-o", self.file("a.png"), "--json",
            self.file("a.json"))
        ablated = self.dump.ablate(vertex="depth:1", visibility=False)
        ablated.save(self.file("same.png"))
        self.assertEqual(content(self.file("same.png")), content(self.file("a.png")))
        self.assertEqual(without(dict(ablated), "seconds"),
                         without(self.figures("a.json"), "seconds"))
        self.assertEqual(ablated["input"]["vertex"], "depth:1")

    def test_the_renderers_choice_is_that_without_one(self) -> None:
        first = {"vertex": "first-rough"}
        self.assertTrue((self.dump.filter(**first).rgb == self.dump.filter().rgb).all())
        for figures in (
                lambda **rule: self.dump.sweep(self.reference, r0=["2px", "6px"], **rule),
                lambda **rule: dict(self.dump.tune(r0=["2px", "6px"], **rule)),
                lambda **rule: dict(self.dump.ablate(self.reference, **rule)),
                lambda **rule: dict(self.dump.explain((5, 5), **rule)),
                lambda **rule: dict(psf.converge(self.paths, self.reference, r0="4px",
                                                 times=False, **rule))):
            self.assertEqual(without(figures(**first), "vertex", "seconds"),
                             without(figures(), "vertex", "seconds"))

    def test_a_rule_that_is_none_is_refused_everywhere(self) -> None:
        bad = {"vertex": "deepest"}
        for call in (lambda: self.dump.filter(**bad), lambda: self.dump.tune(**bad),
                     lambda: self.dump.sweep(self.reference, **bad),
                     lambda: self.dump.ablate(**bad), lambda: self.dump.explain((1, 1), **bad),
                     lambda: psf.converge(self.paths, self.reference, **bad)):
            assert_refused(self, call, 2, "expected first-rough, depth:K")
        with self.assertRaisesRegex(TypeError, "vertex: expected a text"):
            self.dump.filter(vertex=1)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            self.dump.explain((3, 3), vertex="depth:0")
        self.assertIn("the vertices of depth:0 have no channel visibility", str(caught[0].message))


if __name__ == "__main__":
    unittest.main(argv=[__file__])
