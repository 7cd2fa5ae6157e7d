"""The package gives what the commands give, byte for byte; arrays cost no copy where none is needed;
mistakes are exceptions of one line; ^C ends long work.

    package_test.py PACKAGE PROGRAMS SAMPLE_DATA
"""

import json
import os
import subprocess
import sys
import tempfile
import unittest
import warnings
from pathlib import Path

import numpy as np

from support import PACKAGE, SAMPLES, assert_interrupted, assert_refused, content, run

import psf
from psf import _values


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = os.path.join(cls.folder.name, "a.pvb")
        cls.reference = os.path.join(cls.folder.name, "reference.exr")
        scene = os.path.join(SAMPLES, "cornell.json")
        size = ["--size", "32x32", "--quiet"]
        run("psf-render", scene, *size, "--passes", "4", "-o", cls.path)
        run("psf-render", scene, *size, "--passes", "16", "--seed", "9", "--image", cls.reference)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    def file(self, name: str) -> str:
        return os.path.join(self.folder.name, name)

    def same_bytes(self, a: str, b: str) -> bool:
        return content(a) == content(b)

    def test_filter_gives_the_bytes_of_the_command(self) -> None:
        dump = psf.open(self.path)
        for options, parameters in (
                ([], {}),
                (["--r0", "12px", "--delta", "0.5", "--block", "all", "--normal", "off",
                  "--demodulate", "--iterations", "2"],
                 dict(r0="12px", delta=0.5, block="all", normal=None, demodulate=True, iterations=2)),
                (["--no-weights", "--hit-distance", "0.1", "--estimator", "disk"],
                 dict(no_weights=True, hit_distance=0.1, estimator="disk"))):
            run("psf", "filter", self.path, "-o", self.file("c.exr"), *options, "--quiet")
            dump.filter(**parameters).save(self.file("p.exr"))
            self.assertTrue(self.same_bytes(self.file("c.exr"), self.file("p.exr")), options)
        run("psf", "filter", self.path, "-o", self.file("c.png"), "--passes", "1:3", "--quiet")
        dump.filter(passes=slice(1, 3)).save(self.file("p.png"))
        self.assertTrue(self.same_bytes(self.file("c.png"), self.file("p.png")))

    def test_pictures_are_arrays(self) -> None:
        picture = psf.open(self.path).filter()
        self.assertEqual(picture.rgb.shape, (32, 32, 3))
        self.assertEqual(picture.rgb.dtype, np.float32)
        self.assertTrue(np.array_equal(picture.rgb[..., 0], picture["R"]))
        self.assertTrue(np.shares_memory(picture["R"], picture["R"]))
        self.assertGreater(picture.neighbors.mean(), 1)
        self.assertEqual(picture.attributes["psf:r0"], "8px")
        red = picture["R"]
        del picture
        self.assertTrue(np.isfinite(red).all())  # the view keeps its picture

    def test_error_is_that_of_compare(self) -> None:
        picture = psf.open(self.path).filter()
        picture.save(self.file("e.exr"))
        said = self.file("compare.json")
        run("psf", "compare", self.file("e.exr"), self.reference, "--json", said)
        with open(said) as file:
            figures = json.load(file)["rows"][0]["metrics"]
        self.assertEqual(set(figures), set(psf.metrics()))
        for metric, value in figures.items():
            self.assertEqual(picture.error(self.reference, metric), value, metric)
        picture.save(self.file("e.png"))
        with open(self.file("e.png"), "rb") as file:
            self.assertEqual(picture.png(), file.read())
        self.assertNotEqual(picture.png(1), picture.png())
        self.assertEqual(picture.png(), picture._repr_png_())

    def test_channels_are_read_where_they_are_indexed(self) -> None:
        dump = psf.open(self.path)
        out = self.file("npy")
        run("psf", "export", self.path, "-o", out, "--format", "npy", "--quiet")
        for channel in dump.channels:
            expected = np.load(os.path.join(out, channel.name + ".npy"))
            whole = np.asarray(dump[channel.name])
            self.assertTrue(np.array_equal(whole, expected, equal_nan=expected.dtype.kind == "f"),
                            channel.name)
            self.assertTrue(np.array_equal(dump[channel.name][700:90:1], whole[700:90:1]))
            self.assertTrue(np.array_equal(dump[channel.name][10:900:7], whole[10:900:7],
                                           equal_nan=whole.dtype.kind == "f"))
            self.assertTrue(np.array_equal(dump[channel.name][-1], whole[-1],
                                           equal_nan=whole.dtype.kind == "f"))
        with self.assertRaises(IndexError):
            dump["pixel"][dump.records]
        with self.assertRaisesRegex(KeyError, "has no channel colour; it has"):
            dump["colour"]

    def test_arrays_give_the_picture_of_the_file(self) -> None:
        dump = psf.open(self.path)
        names = [c.name for c in dump.channels if c.name not in ("path",)]
        known = {"position", "throughput", "contribution", "pixel", "distance", "unfiltered",
                 "normal", "reflectance", "direction", "hit_distance", "roughness", "visibility",
                 "material", "flags"}
        arrays = {name: dump[name][:] for name in names if name in known}
        result = psf.filter_records(cameras=dump.cameras, parameters={"block": "all"}, n=4, **arrays)
        expected = dump.filter(block="all")
        self.assertTrue(np.array_equal(result.pictures[0].rgb, expected.rgb))
        self.assertEqual(result.c_bar.shape, (dump.records, 3))
        self.assertGreater(float(result.neighbors.mean()), 1)

    def test_a_sweep_is_rows(self) -> None:
        dump = psf.open(self.path)
        rows = dump.sweep(self.reference, metrics=["relMSE", "SSIM"], r0=psf.geomspace(2, 8, 3),
                          normal=[0.9, None])
        self.assertEqual(len(rows), 6)
        self.assertEqual([row["r0"] for row in rows], ["2px", "4px", "8px", "2px", "4px", "8px"])
        for row in rows:
            alone = dump.filter(r0=row["r0"], normal=row["normal"])
            self.assertAlmostEqual(row["relMSE"] / alone.error(self.reference), 1, 4)

    def test_what_is_written_is_read(self) -> None:
        path = self.file("w.pvb")
        camera = psf.Camera("above", 4, 2, 0.1)
        x = np.arange(24, dtype=np.float64).reshape(8, 3)
        channels = {"position": ("f4", 3), "throughput": ("f4", 3), "contribution": ("f4", 3),
                    "distance": "f4", "pixel": "u4", "my.code": ("u2", 2)}
        columns = dict(position=x, throughput=np.ones((8, 3)), contribution=x, distance=np.ones(8),
                       pixel=np.arange(8))
        with psf.create(Path(path), [camera], channels, metadata={"scene": "made"}) as writer:
            for k in range(3):
                writer.append(**columns, **{"my.code": np.full((8, 2), k)})
                writer.commit_pass()
            self.assertEqual((writer.passes, writer.records), (3, 24))
            writer.close()  # and the end of the block does not close it again
        dump = psf.open(path)
        self.assertTrue(dump.closed)
        self.assertEqual(dump.metadata["scene"], "made")
        self.assertTrue(np.array_equal(dump["my.code"][16:], np.full((8, 2), 2)))
        self.assertTrue(np.array_equal(dump["position"][8:16], x.astype(np.float32)))
        for name, wrong in (("distance", np.ones(7)), ("position", np.ones((3, 8))),
                            ("pixel", np.full(8, 1 << 32)), ("pixel", np.full(8, -1)),
                            ("pixel", np.full(8, 0.5))):
            with self.assertRaisesRegex(ValueError, name):
                with psf.create(self.file("x.pvb"), [camera], channels) as writer:
                    writer.append(**{**columns, "my.code": np.ones((8, 2)), name: wrong})
        self.assertFalse(os.path.exists(self.file("x.pvb")))
        # Another byte order is no other value; metadata of another dump are kept, its cameras once.
        with psf.create(self.file("x.pvb"), dump_cameras := psf.open(path).cameras,
                        {name: (">" + kind[0], kind[1]) if isinstance(kind, tuple) else ">" + kind
                         for name, kind in channels.items()},
                        metadata={**psf.open(path).metadata, "mine": 7}) as writer:
            writer.append(**columns, **{"my.code": np.ones((8, 2))})
            writer.commit_pass()
        copy = psf.open(self.file("x.pvb"))
        self.assertTrue(np.array_equal(copy["position"][:], x.astype(np.float32)))
        self.assertEqual((copy.metadata["mine"], copy.metadata["scene"]), (7, "made"))
        self.assertEqual(len(copy.cameras), len(dump_cameras))
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            dump.filter(r0="1px")
        self.assertIn("has no channel", str(said[0].message))

    def test_mistakes_are_one_line(self) -> None:
        dump = psf.open(self.path)
        for call, code, text in (
                (lambda: psf.open("none.pvb"), 4, "none.pvb"),
                (lambda: dump.filter(r0="8 px"), 2, "r0: '8 px' is no radius"),
                (lambda: dump.filter(radius=8), 2, "there is no parameter 'radius'"),
                (lambda: dump.filter(delta=1), 2, "delta: must be in"),
                (lambda: dump.filter(passes=99), 2, "passes"),
                (lambda: dump.filter(block="all", max_memory=1), 5, "max-memory"),
                (lambda: dump.filter().save(self.file("a.jpg")), 2, "a.jpg"),
                (lambda: psf.read_picture(self.path), 3, "a.pvb")):
            assert_refused(self, call, code, text)

    def test_numbers_of_numpy_are_numbers(self) -> None:
        dump = psf.open(self.path)
        picture = dump.filter(iterations=np.int64(2), normal=np.False_, demodulate=np.True_)
        same = dump.filter(iterations=2, normal=None, demodulate=True)
        self.assertTrue(np.array_equal(picture.rgb, same.rgb))
        rows = dump.sweep(self.reference, metrics="MSE", hit_distance=np.float64(0.5))
        self.assertEqual((len(rows), rows[0]["hit_distance"]), (1, "0.5"))
        last = dump.filter(passes=slice(-2, None))
        self.assertTrue(np.array_equal(last.rgb, dump.filter(passes=slice(2, 4)).rgb))
        for wrong in (-1, slice(0, 4, 2)):
            with self.assertRaises(ValueError):
                dump.filter(passes=wrong)
        with self.assertRaisesRegex(KeyError, "has no camera nobody"):
            dump.filter("nobody")

    def test_values_keep_their_digits_and_others_are_named(self) -> None:
        self.assertEqual(_values.texts({"seed": (1 << 64) - 1, "r_min": 1 / 3, "a_b": np.uint64(1 << 63)}),
                         {"seed": "18446744073709551615", "r-min": "0.33333333333333331",
                          "a-b": "9223372036854775808"})
        self.assertEqual(_values.lists({"x": np.array([1, 2]), "y": np.array(0.5), "z": True}),
                         {"x": "1,2", "y": "0.5", "z": "on"})
        dump = psf.open(self.path)
        for call, error, text in (
                (lambda: dump.filter(r0=[8]), TypeError, r"r0: expected a number, text, .* not \[8\]"),
                (lambda: dump.filter(delta=np.zeros((9, 9))), TypeError, "delta: expected a number"),
                (lambda: dump.filter(passes="0:2"), TypeError, "passes: expected a whole number"),
                (lambda: dump.filter(passes=slice("0", "2")), TypeError, "passes: expected a slice"),
                (lambda: dump.filter(max_memory="1G"), TypeError, "max_memory: expected .* not '1G'"),
                (lambda: dump.filter(max_memory=-1), ValueError, "max_memory: -1 is no whole number"),
                (lambda: dump.filter().save(None), TypeError, "path: expected a file name, not None"),
                (lambda: dump.filter().error(5), TypeError, "reference: expected a psf.Picture or"),
                (lambda: psf.open(5), TypeError, "path: expected a file name, not 5"),
                (lambda: psf.read_picture([]), TypeError, "path: expected a file name"),
                (lambda: psf.create(5, [], {}), TypeError, "path: expected a file name")):
            with self.assertRaisesRegex(error, "^" + text) as raised:
                call()
            self.assertNotIn("\n", str(raised.exception))

    def test_paths_are_file_names(self) -> None:
        dump = psf.open(Path(self.path))
        self.assertEqual(dump.path, self.path)
        picture = dump.filter()
        picture.save(Path(self.file("path.exr")))
        again = psf.read_picture(Path(self.file("path.exr")))
        self.assertEqual(picture.error(Path(self.file("path.exr"))), 0)
        self.assertTrue(np.array_equal(again.rgb, picture.rgb))
        dump.explain((0, 0)).save(Path(self.file("path.json")))
        self.assertEqual(len(dump.sweep(Path(self.reference), metrics=(m for m in ["MSE"]))), 1)

    def test_records_of_another_shape_are_refused(self) -> None:
        camera = psf.Camera("above", 2, 2, 0.1)
        columns = dict(position=np.zeros((4, 3)), throughput=np.ones((4, 3)),
                       contribution=np.ones((4, 3)), pixel=np.arange(4), distance=np.ones(4))
        result = psf.filter_records(cameras=[camera], **columns)
        self.assertTrue((result.c_bar == 1).all())
        for name, wrong in (("position", np.zeros((3, 4))), ("distance", np.ones((4, 1))),
                            ("visibility", np.full(4, 1 << 32)), ("flags", np.full(4, 256))):
            with self.assertRaisesRegex(ValueError, name):
                psf.filter_records(cameras=[camera], **{**columns, name: wrong})
        for cameras, code in (([], 2), ([psf.Camera("none", 0, 0)], 3)):
            with self.assertRaises(psf.Error) as raised:
                psf.filter_records(cameras=cameras, **columns)
            self.assertEqual(raised.exception.code, code)
        with self.assertRaisesRegex(psf.Error, "estimator disk"):
            psf.filter_records(cameras=[psf.Camera("flat", 2, 2)], **columns,
                               parameters={"r0": "1wu", "estimator": "disk"}, no_weights=True,
                               normal=np.ones((4, 3)), direction=np.ones((4, 3)))

    def test_a_dump_is_not_refreshed_while_it_is_read(self) -> None:
        dump = psf.open(self.path)
        refused = []

        def refresh(done: int, total: int) -> None:
            try:
                dump.refresh()
            except psf.Error as error:
                refused.append(error.code)

        dump.filter(block="2^6", r0="64px", no_weights=True, progress=refresh)
        self.assertEqual(set(refused) | {2}, {2})
        self.assertFalse(dump.refresh())

    def test_a_thread_that_nobody_waits_for_ends_with_the_program(self) -> None:
        program = """
import sys, threading, time
sys.path.insert(0, sys.argv[1])
import psf
dump = psf.open(sys.argv[2])

def work():
    while True:  # some long, some so short that the end comes between two
        dump.filter(r0="64px")
        dump.filter(r0="0", passes=1, progress=lambda done, total: None)

for _ in range(4):
    threading.Thread(target=work, daemon=True).start()
time.sleep(float(sys.argv[3]))
"""
        for seconds in ("0", "0.05", "0.1", "0.2"):
            ended = subprocess.run([sys.executable, "-B", "-c", program, PACKAGE, self.path, seconds],
                                   capture_output=True, text=True)
            self.assertEqual((ended.returncode, ended.stdout, ended.stderr), (0, "", ""))

    def test_progress_is_said_and_what_it_raises_ends_the_work(self) -> None:
        dump = psf.open(self.path)
        seen = []
        dump.filter(block="2^8", progress=lambda done, total: seen.append((done, total)))
        self.assertEqual(seen[-1], (dump.records, dump.records))
        with self.assertRaises(ZeroDivisionError):
            dump.filter(block="2^8", r0="64px", no_weights=True, progress=lambda done, total: 1 // 0)
        dump.filter()  # and the next call works

    def test_an_interrupt_ends_long_work_and_the_lock_is_free(self) -> None:
        dump = psf.open(self.path)
        assert_interrupted(self, lambda: dump.filter(block="2^6", r0="64px", no_weights=True, iterations=2))
        dump.filter()

    def test_the_example_runs(self) -> None:
        example = os.path.join(os.path.dirname(os.path.abspath(__file__)), "example.py")
        said = subprocess.run(
            [sys.executable, "-B", example, self.path, self.reference, self.file("x.exr")],
            env=dict(os.environ, PYTHONPATH=PACKAGE), check=True, capture_output=True, text=True)
        self.assertIn("(100, 3) True", said.stdout)
        self.assertEqual(said.stdout.splitlines()[-3:-1], ["True", "True"])
        run("psf", "filter", self.path, "-o", self.file("y.exr"), "--r0", "12px", "--delta",
            f"{1 / 3:.17g}", "--quiet")
        self.assertTrue(self.same_bytes(self.file("x.exr"), self.file("y.exr")))

    def test_the_parameters_are_those_of_the_command(self) -> None:
        said = run("psf", "filter", "--help")
        for parameter in psf.parameters():
            self.assertIn("--" + parameter.name.replace("_", "-"), said)
            self.assertTrue(parameter.help and parameter.default)
        self.assertIn("path-vertex", psf.__doc__)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
