"""Studies give the figures of their commands to the last digit, and the bytes of their files.

    studies_test.py PACKAGE PROGRAMS SAMPLE_DATA
"""

import json
import math
import os
import tempfile
import unittest
import warnings
from collections.abc import Callable
from pathlib import Path

from support import CORNELL, assert_refused, content, run

import psf


class Studies(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        size = ["--size", "24x24", "--quiet"]
        cls.paths = [cls.file(f"{seed}.pvb") for seed in range(3)]
        for seed, path in enumerate(cls.paths):
            run("psf-render", CORNELL, *size, "--passes", "8", "--seed", str(seed), "-o", path,
                "--json", path + ".json")
        cls.reference = cls.file("reference.exr")
        run("psf-render", CORNELL, *size, "--passes", "32", "--seed", "9", "--image", cls.reference)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    @classmethod
    def file(cls, name: str) -> str:
        return os.path.join(cls.folder.name, name)

    def test_tune_gives_the_figures_of_the_command(self) -> None:
        command = self.file("tune.json")
        run("psf", "tune", self.paths[0], "--delta", "0.2,0.333333", "--normal", "0.9,off",
            "--json", command)
        dump = psf.open(self.paths[0])
        tuning = dump.tune(normal=[0.9, None], delta=[0.2, 0.333333])
        tuning.save(self.file("same.json"))
        self.assertEqual(content(self.file("same.json")), content(command))
        with open(command, encoding="utf-8") as file:
            self.assertEqual(dict(tuning), json.load(file))
        self.assertEqual(len(tuning.rows), 9 * 2 * 2)
        self.assertEqual([row["error"] for row in tuning.rows],
                         [row["error"] for row in tuning["rows"]])
        self.assertEqual(tuning.rows[0]["r0"], tuning.best["r0"])
        run("psf", "filter", self.paths[0], "--tuned", command, "-o", self.file("c.exr"), "--quiet")
        dump.filter(**tuning.best).save(self.file("p.exr"))
        self.assertEqual(content(self.file("c.exr")), content(self.file("p.exr")))

    def test_ablate_gives_the_sheet_and_the_figures_of_the_command(self) -> None:
        sheet, figures = self.file("parts.png"), self.file("parts.json")
        run("psf", "ablate", self.paths[0], "--reference", self.reference, "--metric", "FLIP",
            "--crop", "2,3,16x8", "--exposure", "1", "--normal", "0.9", "-o", sheet, "--json", figures)
        dump = psf.open(self.paths[0])
        study = dump.ablate(self.reference, metric="FLIP", crop=(2, 3, 16, 8), exposure=1,
                            normal=0.9)
        study.save(self.file("same.png"))
        self.assertEqual(content(self.file("same.png")), content(sheet))
        self.assertEqual(study._repr_png_(), content(sheet))
        with open(figures, encoding="utf-8") as file:
            expected = json.load(file)
        got = dict(study)
        for rows in (expected["rows"], got["rows"]):
            for row in rows:
                del row["seconds"]
        self.assertEqual(got, expected)
        self.assertEqual([row["label"] for row in study.rows],
                         [row["label"] for row in expected["rows"]])
        self.assertEqual(len(study.pictures), len(study.rows))
        last = dump.filter(passes=1, iterations=8, normal=0.9)
        self.assertTrue((study.pictures[-1].rgb == last.rgb).all())
        assert_refused(self, lambda: dump.ablate(crop=(0, 0, 99, 1)), 2, "crop 0,0,99x1")
        self.assertEqual(dict(dump.ablate())["metrics"], [])

    def test_converge_gives_the_files_of_the_command(self) -> None:
        run("psf", "converge", *self.paths, "--reference", self.reference, "--r0", "2px:8px:x2",
            "--normal", "0.9,off", "--no-times", "--quiet", "-o", self.file("command"))
        study = psf.converge([psf.open(self.paths[0]), *self.paths[1:]], self.reference,
                             normal=[0.9, None], r0="2px:8px:x2", times=False)
        study.save(self.file("same"))
        for name in ("converge.json", "converge.csv"):
            self.assertEqual(content(self.file("same/" + name)),
                             content(self.file("command/" + name)), name)
        # Flat rows: those of the points of the series, in the same order.
        points = [(series["id"], point) for series in study["series"] for point in series["points"]]
        self.assertEqual(len(study.rows), len(points))
        self.assertEqual(len(points), (1 + 3 * 2) * 4)
        for row, (id, point) in zip(study.rows, points):
            self.assertEqual((row["id"], row["n"], row["relMSE"], row["variance"]),
                             (id, point["n"], point["metrics"]["relMSE"], point["variance"]))
        self.assertEqual(study.rows[-1]["normal"], "off")
        self.assertTrue(math.isnan(study.rows[-1]["slope_relMSE"]))  # there is no next point

    def test_converge_counts_the_time_of_the_renders(self) -> None:
        with open(self.paths[1] + ".json", encoding="utf-8") as file:
            figures = json.load(file)
        study = psf.converge(self.paths, self.reference, passes=4, r0="4px",
                             renders=[self.paths[0] + ".json", figures])
        self.assertEqual(study["n"], [1, 2, 4])
        self.assertEqual([gain["n"] for gain in study["speedups"]], [1, 2, 4])
        with self.assertRaisesRegex(psf.Error, "renders: has no number 'passes'"):
            psf.converge(self.paths, self.reference, r0="4px", renders=[{"seconds": 1}])

    def test_what_is_saved_is_whole_and_over_nothing(self) -> None:
        dump = psf.open(self.paths[0])
        before = content(self.paths[0])
        tuning = dump.tune(r0=["4px", "8px"])
        study = psf.converge(dump, self.reference, r0="4px", times=False)
        os.makedirs(self.file("linked"))
        os.symlink(self.paths[0], self.file("linked/converge.csv"))
        study.save(Path(self.file("once")))
        with open(self.file("a-file"), "w", encoding="utf-8"):
            pass
        for call, code, text in (
                (lambda: tuning.save(self.paths[0]), 2, "writing it would overwrite the input"),
                (lambda: study.save(self.file("linked")), 2, "writing it would overwrite the input"),
                (lambda: study.save(self.file("once")), 2, "converge.json: is there already"),
                (lambda: study.save(self.file("a-file")), 4, "cannot be made as a folder"),
                (lambda: tuning.save(self.file("none/tune.json")), 4, "none")):
            self.fails(call, code, text)
        self.assertEqual(content(self.paths[0]), before)
        self.assertEqual(os.listdir(self.file("linked")), ["converge.csv"])
        tuning.save(Path(self.file("once.json")))
        tuning.save(self.file("once.json"))  # over a file that is no input

    def test_one_is_as_good_as_a_list_of_one(self) -> None:
        figures = self.paths[0] + ".json"
        with open(figures, encoding="utf-8") as file:
            loaded = json.load(file)
        study = psf.converge([self.paths[0]], self.reference, r0="4px", renders=[figures])
        for dumps, renders in ((self.paths[0], figures), (Path(self.paths[0]), Path(figures)),
                               (psf.open(self.paths[0]), loaded),
                               ((path for path in self.paths[:1]), (one for one in [loaded]))):
            same = psf.converge(dumps, Path(self.reference), r0=(r for r in ["4px"]), renders=renders)
            self.assertEqual(same["inputs"], study["inputs"])
            self.assertEqual(len(same["speedups"]), len(study["speedups"]))
        with self.assertRaisesRegex(TypeError, "^renders: None, .* not rendered here"):
            psf.converge(self.paths, self.reference, renders=[psf.open(self.paths[0]).rendered])
        for text in ("{}", "not JSON"):
            with open(self.file("wrong.json"), "w", encoding="utf-8") as file:
                file.write(text)
            self.fails(lambda: psf.converge(self.paths, self.reference, renders=[
                figures, self.file("wrong.json")]), 3, "wrong.json: has no number 'passes'")
        self.fails(lambda: psf.converge(self.paths, self.reference, renders="none.json"), 4,
                   "none.json: cannot be read")

    def test_arguments_of_other_types_are_named(self) -> None:
        dump = psf.open(self.paths[0])
        for call, error, text in (
                (lambda: dump.explain((-1, 1)), ValueError, "pixel: -1 is no whole number"),
                (lambda: dump.explain((1, 2, 3)), TypeError, r"pixel: expected \(x, y\)"),
                (lambda: dump.explain("corner"), TypeError, "pixel: expected a whole number"),
                (lambda: dump.explain(path=-1), ValueError, "path: -1 is no whole number"),
                (lambda: dump.tune(epsilon="1%"), TypeError, "epsilon: expected a number"),
                (lambda: dump.tune(r0={"4px": 1}), TypeError, "r0: expected a number, text"),
                (lambda: dump.sweep(None), TypeError, "reference: expected a psf.Picture or a file"),
                (lambda: dump.sweep(self.reference, metrics=5), psf.Error, '.*"5"'),
                (lambda: psf.converge([5], self.reference), TypeError, "path: expected a file name"),
                (lambda: psf.converge([dump, 5], self.reference), TypeError, "dumps: expected a file"),
                (lambda: psf.converge(dump, self.reference, passes="4"), TypeError, "passes: expected"),
                (lambda: psf.converge(dump, self.reference, renders=5), TypeError, "renders: expected")):
            with self.assertRaisesRegex(error, "^" + text) as raised:
                call()
            self.assertNotIn("\n", str(raised.exception))

    def fails(self, call: Callable[[], object], code: int, text: str) -> None:
        with self.assertRaises(psf.Error) as raised:
            call()
        self.assertEqual(raised.exception.code, code, raised.exception)
        self.assertIn(text, str(raised.exception))

    def test_explain_says_what_the_command_says(self) -> None:
        dump = psf.open(self.paths[0])
        said = run("psf", "explain", self.paths[0], "--pixel", "3,20", "--visibility=off",
                   "--json", self.file("c.json"), "--ply", self.file("c.ply"))
        explained = dump.explain((3, 20), visibility=None)
        self.assertEqual(str(explained), said)
        for end in ("json", "ply"):
            explained.save(self.file("p." + end))
            self.assertEqual(content(self.file("p." + end)), content(self.file("c." + end)))
        with open(self.file("c.json"), encoding="utf-8") as file:
            self.assertEqual(dict(explained), json.load(file))
        said = run("psf", "explain", self.paths[0], "--pixel", "3,20", "--fit", "linear",
                   "--fireflies", "spread", "--json", self.file("f.json"))
        explained = dump.explain((3, 20), fit="linear", fireflies="spread")
        self.assertEqual(str(explained), said)
        with open(self.file("f.json"), encoding="utf-8") as file:
            self.assertEqual(dict(explained), json.load(file))
        self.assertIn("weight", explained["paths"][0]["neighbors"])
        said = run("psf", "explain", self.paths[0], "--path", "77", "--all", "--passes", "0:4")
        self.assertEqual(dump.explain(path=77, passes=4).text(None), said)

    def test_a_sweep_has_the_order_of_the_command(self) -> None:
        dump = psf.open(self.paths[0])
        run("psf", "sweep", self.paths[0], "--reference", self.reference, "--normal", "0.9,off",
            "--r0", "2px,4px", "-o", self.file("sweep"), "--quiet")
        with open(self.file("sweep/sweep.json"), encoding="utf-8") as file:
            expected = json.load(file)["rows"]
        rows = dump.sweep(self.reference, r0=["2px", "4px"], normal=[0.9, None])
        self.assertEqual([(row["r0"], row["normal"], row["relMSE"], row["neighbors"])
                          for row in rows],
                         [(row["parameters"]["r0"], row["parameters"]["normal"],
                           row["metrics"]["relMSE"], row["neighbors"]) for row in expected])

    def test_mistakes_are_one_line(self) -> None:
        dump = psf.open(self.paths[0])
        for call, code, text in (
                (lambda: dump.tune(r0="4px,,8px"), 2, "r0: '4px,,8px' has an empty value"),
                (lambda: dump.tune(radius=1), 2, "there is no parameter 'radius'"),
                (lambda: dump.tune(block="all"), 2, "block"),
                (lambda: dump.explain((24, 0)), 2, "24"),
                (lambda: dump.explain(path=1 << 40), 2, "path"),
                (lambda: dump.explain((0, 0)).save(self.file("a.txt")), 2, ".json or .ply"),
                (lambda: psf.converge([], self.reference), 2, "dumps"),
                (lambda: psf.converge(self.paths[:1] * 2, self.reference), 3, "has the seed 0"),
                (lambda: psf.converge(self.paths, self.reference, passes=99), 2, "passes")):
            assert_refused(self, call, code, text)
        with self.assertRaisesRegex(ValueError, "r0: an empty list"):
            dump.tune(r0=[])
        for wrong in ({}, {"pixel": (0, 0), "path": 1}):
            with self.assertRaises(TypeError):
                dump.explain(**wrong)
        with self.assertRaisesRegex(KeyError, "has no camera nobody"):
            dump.tune(camera="nobody")

    def test_what_a_dump_lacks_is_said(self) -> None:
        run("psf", "cat", self.paths[0], "-o", self.file("thin.pvb"), "--drop", "visibility")
        dump = psf.open(self.file("thin.pvb"))
        for call in (lambda: dump.tune(r0="4px"), lambda: dump.explain((3, 20)),
                     lambda: psf.converge([dump], self.reference, r0="4px")):
            with warnings.catch_warnings(record=True) as said:
                warnings.simplefilter("always")
                call()
            self.assertEqual(len(said), 1)
            self.assertIn("has no channel visibility", str(said[0].message))
        self.assertEqual(dump.explain((3, 20))["parameters"]["visibility"], "off")


if __name__ == "__main__":
    unittest.main(argv=["studies_test"])
