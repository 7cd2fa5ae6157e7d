"""Sequences of frames: the package gives the bytes of psf filter, a picture a frame, and the figures and
the sheet of psf flicker.

    frames_test.py PACKAGE PROGRAMS SAMPLE_DATA
"""

import json
import os
import subprocess
import sys
import tempfile
import unittest
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from support import PACKAGE, PROGRAMS, SAMPLES, assert_interrupted, assert_refused, content, run

import psf

if not os.path.exists(os.path.join(PROGRAMS, "psf-render")):
    print("skipped: built without the renderer")
    sys.exit(77)


class Frames(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.path, cls.many = cls.file("all.pvb"), cls.file("one.####.pvb")
        for path in (cls.path, cls.many):
            run("psf-render", os.path.join(SAMPLES, "lantern.json"), "--size", "32x24", "--passes", "2",
                "--channels", "default,rest_position", "--frames", "3:6", "--quiet", "-o", path)
        cls.sequence = psf.open_sequence(cls.path)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    @classmethod
    def file(cls, name: str) -> str:
        return os.path.join(cls.folder.name, name)

    def save(self, pictures: list[psf.Picture], name: str) -> str:
        for frame, picture in zip(self.sequence.frames, pictures):
            picture.save(self.file(name.replace("####", f"{frame:04}")))
        return self.file(name)

    def test_a_picture_a_frame_has_the_bytes_of_the_command(self) -> None:
        self.assertEqual(self.sequence.frames, [3, 4, 5])
        seen = set()
        for options, how in (
                ([], {}), (["--window", "1"], dict(window=1)), (["--window", "3"], dict(window=3)),
                (["--window", "3", "--relit", "off"], dict(window=3, relit=None)),
                (["--window", "5", "--relit", "2.5", "--positions", "world", "--r0", "4px", "--plane",
                  "0.5"], dict(window=5, relit=2.5, positions="world", r0="4px", plane=0.5))):
            run("psf", "filter", self.path, "-o", self.file("c.####.exr"), "-o", self.file("c.####.png"),
                *options, "--quiet")
            for sequence in (self.sequence, psf.open_sequence(Path(self.many))):
                pictures = sequence.filter(**how)
                self.assertEqual(len(pictures), 3)
                for ending in ("exr", "png"):
                    self.save(pictures, "p.####." + ending)
                    for frame in ("0003", "0004", "0005"):
                        got = content(self.file(f"p.{frame}.{ending}"))
                        expected = content(self.file(f"c.{frame}.{ending}"))
                        if sequence is self.sequence or ending == "png":  # an EXR names its dump
                            self.assertEqual(got, expected, (options, frame, ending))
                        if ending == "png":
                            seen.add(got)
        self.assertEqual(len(seen), 4 * 3)  # but for window 1, each of the settings is another one

    def test_a_dump_a_frame_has_the_bytes_of_the_command_too(self) -> None:
        run("psf", "filter", self.many, "-o", self.file("m.####.exr"), "--window", "3", "--quiet")
        self.save(psf.open_sequence(self.many).filter(window=3), "n.####.exr")
        for frame in ("0003", "0004", "0005"):
            self.assertEqual(content(self.file(f"n.{frame}.exr")), content(self.file(f"m.{frame}.exr")))

    def test_chosen_frames_are_those_of_all(self) -> None:
        all = self.sequence.filter(window=3)
        for chosen in (4, [4], np.array([4]), range(4, 5)):
            one, = self.sequence.filter(chosen, window=3)
            self.assertTrue(np.array_equal(one.rgb, all[1].rgb))
        self.assertEqual(one.attributes["psf:window"], "3")
        self.assertEqual(one.attributes["psf:positions"], "rest")
        self.assertNotIn("psf:window", self.sequence.filter(4)[0].attributes)
        camera = self.sequence.cameras[0].name
        self.assertTrue(np.array_equal(
            self.sequence.filter(4, camera, window=3)[0].rgb, one.rgb))
        self.assertEqual([len(pictures) for pictures in self.sequence.filter_all()], [1, 1, 1])

    def figures(self, name: str) -> Any:
        with open(self.file(name), encoding="utf-8") as file:
            return json.load(file)

    def test_flicker_gives_the_figures_and_the_sheet_of_the_command(self) -> None:
        alone, shared = self.sequence.filter(), self.sequence.filter(window=3)
        a, b = self.save(alone, "a.####.exr"), self.save(shared, "b.####.exr")
        for options, how in (
                (["--frames", "3:6"], {}),
                (["--frames", "3:6", "--trim", "5%", "--epsilon", "0.1", "--exposure", "1", "--columns",
                  "2"], dict(trim=0.05, epsilon=0.1, exposure=1, columns=2))):
            run("psf", "flicker", a, b, "--reference", a, "--label", "one", "--label", "two", "--sheet",
                self.file("c.png"), "--json", self.file("c.json"), *options)
            study = psf.flicker({"one": a, "two": b}, a, frames=range(3, 6), **how)
            study.save(self.file("p.png"))
            self.assertEqual(content(self.file("p.png")), content(self.file("c.png")))
            self.assertEqual(study._repr_png_(), content(self.file("c.png")))
            self.assertEqual(dict(study), self.figures("c.json"))
            self.assertEqual(study._result.json.encode(), content(self.file("c.json")))
            rows = [{name: row[name] for name in ("label", "error", "flicker", "left_out")}
                    for row in study["rows"]]
            self.assertEqual(study.rows, rows)
            # Pictures in memory, and files one by one, have the figures of the files.
            names = [self.file(f"b.{frame:04}.exr") for frame in (3, 4, 5)]
            for mixed in (shared, names, [shared[0], Path(names[1]), shared[2]]):
                same = psf.flicker({"one": a, "two": mixed}, alone, frames=range(3, 6), **how)
                self.assertEqual(same.rows, rows)
                self.assertIsNone(same["reference"])
        self.assertEqual(rows[0]["flicker"], 0)
        self.assertGreater(rows[1]["flicker"], 0)
        self.assertEqual(psf.flicker(shared, alone)["first"], 0)
        self.assertIn("flicker 0.", repr(study))

    def test_mistakes_are_one_line(self) -> None:
        sequence, pictures = self.sequence, self.sequence.filter()
        name = self.save(pictures, "e.####.exr")
        small = psf.render_picture(os.path.join(SAMPLES, "cornell.json"), self.file("small.exr"),
                                   size=(8, 8), passes=1)
        run("psf", "cat", self.path, "-o", self.file("bare.pvb"), "--drop", "rest_position", "--quiet")
        run("psf-render", os.path.join(SAMPLES, "cornell.json"), "--size", "8x8", "--passes", "1", "--quiet",
            "-o", self.file("still.pvb"))
        for call, code, text in (
                (lambda: psf.open_sequence(self.file("none.pvb")), 4, "none.pvb"),
                (lambda: psf.open_sequence(self.file("no.####.pvb")), 4, "no file has this name"),
                (lambda: psf.open_sequence(self.file("still.pvb")), 2, "tells of no frames"),
                (lambda: sequence.filter(6), 2, "has the frames 3:6, 6 is none of them"),
                (lambda: psf.open_sequence(self.many).filter(6), 2, "has the frames 3 to 5, 6 is none"),
                (lambda: sequence.filter(window=2), 2, "window 2: as many frames before as behind"),
                (lambda: sequence.filter(window=0), 2, "give an odd number"),
                (lambda: sequence.filter(relit=2), 2, "relit: is about other frames; give window K"),
                (lambda: sequence.filter(window=3, relit=0), 2, "relit: '0': write a number above 0"),
                (lambda: sequence.filter(window=3, positions="here"), 2, "write rest or world"),
                (lambda: sequence.filter(window=3, plane=1), 2, "give plane off or positions world"),
                (lambda: sequence.filter(window=3, iterations=2), 2, "cannot be averaged again"),
                (lambda: sequence.filter(window=3, vertex="deepest"), 2, "expected first-rough"),
                (lambda: sequence.filter(radius=2), 2, "there is no parameter 'radius'"),
                (lambda: sequence.filter(block="2^6", max_memory=1), 5, "max-memory"),
                (lambda: psf.open_sequence(self.file("bare.pvb")).filter(window=3, positions="rest"), 3,
                 "has no channel rest_position"),
                (lambda: psf.flicker(name, name), 2, "has 0 frames from 0 on"),
                (lambda: psf.flicker(name, name, frames=[3, 4]), 2, "frames: 3:5: flicker takes at least 3"),
                (lambda: psf.flicker(name, name, frames=range(3, 7)), 4, "e.0006.exr"),
                (lambda: psf.flicker(self.file("e.0003.exr"), name, frames=[3, 4, 5]), 2,
                 "a sequence has #### in its name"),
                (lambda: psf.flicker(pictures[:2], pictures), 2, "pictures: 2 pictures for the frames 0:3"),
                (lambda: psf.flicker(pictures, pictures[:2], frames=[0, 1, 2]), 2, "reference: 2 pictures"),
                (lambda: psf.flicker({}, pictures), 2, "pictures: at least one sequence"),
                (lambda: psf.flicker([small] * 3, pictures), 3, "compare pictures of one size"),
                (lambda: psf.flicker(pictures, pictures, trim=1), 2, "trim: 1: is a share"),
                (lambda: psf.flicker(pictures, pictures, epsilon=0), 2, "epsilon: must be > 0"),
                (lambda: psf.flicker(pictures, pictures, columns=0), 2, "columns: at least one"),
                (lambda: psf.flicker(name, name, frames=[3, 4, 5]).save(self.file("e.0004.exr")), 2,
                 "overwrite the input"),
                (lambda: psf.flicker([self.file(f"e.000{frame}.exr") for frame in (3, 4, 5)],
                                     pictures).save(self.file("e.0004.exr")), 2, "overwrite the input")):
            assert_refused(self, call, code, text)
        for other, error, text in (
                (lambda: psf.open_sequence(5), TypeError, "path: expected a file name"),
                (lambda: sequence.filter("3"), TypeError, "frames: expected a whole number"),
                (lambda: sequence.filter(-1), ValueError, "frames: -1 is no whole number"),
                (lambda: sequence.filter(window="3"), TypeError, "window: expected a whole number"),
                (lambda: sequence.filter(positions=None), TypeError, "positions: expected 'rest'"),
                (lambda: sequence.filter(3, "nobody"), KeyError, ".*has no camera nobody"),
                (lambda: psf.flicker(5, pictures), TypeError, "pictures: expected a name with ####"),
                (lambda: psf.flicker(pictures[0], pictures), TypeError, "pictures: expected a name"),
                (lambda: psf.flicker([5], pictures), TypeError, "pictures: expected a psf.Picture or"),
                (lambda: psf.flicker({1: pictures}, pictures), TypeError, "pictures: expected labels"),
                (lambda: psf.flicker(name, name, frames=[3, 5, 6]), ValueError, "frames: expected numbers")):
            with self.assertRaisesRegex(error, "^['\"]?" + text) as raised:
                other()
            self.assertNotIn("\n", str(raised.exception))

    def test_what_a_dump_lacks_is_said_once(self) -> None:
        run("psf", "cat", self.path, "-o", self.file("thin.pvb"), "--drop", "visibility", "--quiet")
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            psf.open_sequence(self.file("thin.pvb")).filter(window=3)
        self.assertEqual(len(said), 1)
        self.assertIn("has no channel visibility", str(said[0].message))

    def test_progress_is_that_of_all_frames(self) -> None:
        seen: list[tuple[int, int]] = []
        self.sequence.filter(window=3, progress=lambda done, total: seen.append((done, total)))
        paths = psf.open(self.path).records
        self.assertEqual(seen[-1], (paths, paths))
        self.assertEqual([done for done, _ in seen], sorted(done for done, _ in seen))
        pictures = self.sequence.filter()
        psf.flicker(pictures, pictures, progress=lambda done, total: seen.append((done, total)))
        self.assertEqual(seen[-1], (3, 3))
        with self.assertRaises(ZeroDivisionError):
            self.sequence.filter(window=3, progress=lambda done, total: 1 // 0)

    def test_an_interrupt_ends_both_and_the_lock_is_free(self) -> None:
        pictures = self.sequence.filter()
        calls = (lambda: self.sequence.filter(window=3, block="2^6", r0="64px", no_weights=True),
                 lambda: psf.flicker(pictures * 200, pictures * 200))
        for call in calls:
            assert_interrupted(self, call)
            self.sequence.filter(3)  # and the next call works

    def test_the_example_runs(self) -> None:
        example = os.path.join(os.path.dirname(os.path.abspath(__file__)), "frames_example.py")
        said = subprocess.run([sys.executable, "-B", example, self.path, self.file("x.####.exr")],
                              env=dict(os.environ, PYTHONPATH=PACKAGE), check=True,
                              capture_output=True, text=True).stdout.splitlines()
        self.assertIn("3 frames from 3 on", said[0])
        self.assertEqual(said[1:], ["2", "['alone', 'window 3'] 0.0", "True"])


if __name__ == "__main__":
    unittest.main(argv=[__file__])
