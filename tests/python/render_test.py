"""psf.render() writes what psf-render writes: records, pictures, figures, errors.

    render_test.py PACKAGE PROGRAMS SAMPLE_DATA
"""

import gc
import json
import os
import signal
import sys
import tempfile
import threading
import unittest
import warnings
from pathlib import Path

import numpy as np

from support import CORNELL, PACKAGE, SAMPLES, content, run

import psf

if not any(name.startswith("_render.") and name.endswith(".so")
           for name in os.listdir(os.path.join(PACKAGE, "psf"))):
    print("skipped: built without the renderer")
    sys.exit(77)


class Render(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def file(self, name: str) -> str:
        return os.path.join(self.folder.name, name)

    def same_dump(self, a: psf.Dump, b: psf.Dump) -> None:
        self.assertEqual(a.metadata, b.metadata)
        self.assertEqual([one.name for one in a.channels], [one.name for one in b.channels])
        for channel in a.channels:
            self.assertEqual(a[channel.name][:].tobytes(), b[channel.name][:].tobytes())

    def test_a_render_is_that_of_the_command(self) -> None:
        run("psf-render", CORNELL, "--size", "20x16", "--passes", "3", "--seed", "7", "--sampler",
            "halton", "--shade-rate", "1/2", "--sun", "0,1,0.5", "--sun-irradiance", "2",
            "--channels", "normal,visibility", "-o", self.file("c.pvb"), "--image",
            self.file("c.exr"), "--image", self.file("c.png"), "--quiet")
        dump = psf.render(CORNELL, self.file("p.pvb"), size=(20, 16), passes=3, seed=7,
                          sampler="halton", shade_rate="1/2", sun=(0, 1, 0.5), sun_irradiance=2,
                          channels=["normal", "visibility"],
                          image=[self.file("p.exr"), self.file("p.png")])
        self.same_dump(dump, psf.open(self.file("c.pvb")))
        for end in ("exr", "png"):
            self.assertEqual(content(self.file("p." + end)), content(self.file("c." + end)))
        self.assertEqual((dump.passes, dump.rendered["paths"]), (3, 3 * 20 * 16))
        self.assertEqual(dump.rendered["bytes"], os.path.getsize(self.file("p.pvb")))

    def test_a_sequence_is_that_of_the_command_in_one_dump_and_in_many(self) -> None:
        lantern = os.path.join(SAMPLES, "lantern.json")
        how = dict(size=(20, 16), passes=2, channels=["default", "rest_position"])
        for name in ("all.pvb", "one.####.pvb"):
            run("psf-render", lantern, "--size", "20x16", "--passes", "2", "--channels",
                "default,rest_position", "--frames", "3:6", "--quiet", "-o", self.file("c." + name),
                "--image", self.file("c.####.exr"))
            sequence = psf.render_sequence(lantern, self.file("p." + name), frames=range(3, 6),
                                           image=self.file("p.####.exr"), **how)
            self.assertEqual((sequence.frames, sequence.path), ([3, 4, 5], self.file("p." + name)))
            self.assertEqual(sequence.rendered["paths"], 3 * 2 * 20 * 16)
            expected = psf.open_sequence(self.file("c." + name)).filter(window=3)
            for frame, got, other in zip((3, 4, 5), sequence.filter(window=3), expected):
                self.assertTrue(np.array_equal(got.rgb, other.rgb))
                self.assertEqual(content(self.file(f"p.000{frame}.exr")),
                                 content(self.file(f"c.000{frame}.exr")))
        sequence = psf.render_sequence(lantern, frames=[4], **how)
        self.assertTrue(np.array_equal(
            sequence.filter()[0].rgb, psf.open(self.file("c.one.0004.pvb")).filter().rgb))
        path = sequence.path
        del sequence
        gc.collect()
        self.assertFalse(os.path.exists(path))
        with self.assertRaisesRegex(psf.Error, "r.####.pvb: a dump a frame; psf.render_sequence()"):
            psf.render(lantern, self.file("r.####.pvb"), frames="0:2", **how)
        with self.assertRaisesRegex(ValueError, "^frames: expected numbers one after the other"):
            psf.render_sequence(lantern, frames=[], **how)

    def test_the_light_of_a_render_is_weighed_afterwards(self) -> None:
        dump = psf.render(CORNELL, self.file("p.pvb"), size=(20, 16), passes=2, layers="bounces")
        picture = dump.filter()
        self.assertEqual(picture.light_layers, ["direct", "indirect", "camera"])
        relit = picture.relight(direct=2, indirect=(1, 0.5, np.float32(0)))
        relit.save(self.file("p.exr"))
        run("psf", "filter", self.file("p.pvb"), "-o", self.file("c.exr"), "--quiet")
        run("psf", "relight", self.file("c.exr"), "direct=2", "indirect=1,0.5,0", "-o",
            self.file("r.exr"))
        self.assertEqual(content(self.file("p.exr")), content(self.file("r.exr")))
        np.testing.assert_allclose(relit["R"], 2 * picture["direct.R"] + picture["indirect.R"] +
                                   picture["camera.R"], rtol=1e-6)
        with self.assertRaisesRegex(psf.Error, "there are direct, indirect, camera"):
            picture.relight(moon=1)
        with self.assertRaisesRegex(TypeError, "direct: expected a number or three"):
            picture.relight(direct=(1, 2))
        with self.assertRaisesRegex(psf.Error, "has no layers of the light"):
            psf.read_picture(self.file("c.exr")).relight(direct=1)

    def test_alpha_and_the_background_are_apart(self) -> None:
        scene = os.path.join(SAMPLES, "fence.json")
        view = dict(size=(20, 16), passes=2, eye=(6, 1.2, 9), target=(0, 1.2, 0), fov=50)
        plain = psf.render(scene, self.file("a.pvb"), **view).filter()
        picture = psf.render(scene, self.file("b.pvb"), channels="default,alpha", **view).filter()
        self.assertIsNone(plain.alpha)
        self.assertIsNone(plain.background)
        alpha, background = picture.alpha, picture.background
        assert alpha is not None and background is not None
        self.assertEqual((alpha.shape, alpha.min(), alpha.max()), ((16, 20), 0, 1))
        np.testing.assert_allclose(picture.rgb + background, plain.rgb, rtol=1e-6)
        self.assertEqual(picture.png(), plain.png())
        self.assertLess(picture.error(plain), 1e-12)

    def test_the_figures_are_named_as_those_of_the_command(self) -> None:
        run("psf-render", CORNELL, "--size", "4x4", "--passes", "1", "-o", self.file("c.pvb"),
            "--json", self.file("c.json"), "--quiet")
        dump = psf.render(CORNELL, self.file("p.pvb"), size=(4, 4), passes=1)
        with open(self.file("c.json"), encoding="utf-8") as file:
            expected = json.load(file)
        self.assertEqual(list(dump.rendered), list(expected))
        for name in ("scene", "passes", "paths", "rays", "non_finite", "images"):
            self.assertEqual(dump.rendered[name], expected[name])

    def test_without_a_name_the_dump_goes_with_what_holds_it(self) -> None:
        dump = psf.render(CORNELL, size=(8, 8), passes=2)
        path = dump.path
        self.assertEqual(os.path.basename(path), "cornell.pvb")
        positions = dump["position"]
        del dump
        gc.collect()
        self.assertEqual(positions[:].shape, (2 * 64, 3))  # what is open can be read
        self.assertFalse(os.path.exists(os.path.dirname(path)))

    def test_a_picture_needs_no_dump(self) -> None:
        run("psf-render", CORNELL, "--size", "8x8", "--passes", "4", "--image", self.file("c.exr"),
            "--quiet")
        picture = psf.render_picture(CORNELL, self.file("p.exr"), size=(8, 8), passes=4)
        self.assertEqual(content(self.file("p.exr")), content(self.file("c.exr")))
        self.assertTrue(np.array_equal(picture.rgb, psf.read_picture(self.file("c.exr")).rgb))
        self.assertEqual(os.listdir(self.folder.name).count("p.pvb"), 0)

    def test_a_picture_that_cannot_be_read_back_is_refused_before(self) -> None:
        for path, settings, error, text in (
                (self.file("p.png"), {}, psf.Error, ".*p.png: the picture is read back"),
                ([self.file("p.exr")], {}, TypeError, "path: expected a file name"),
                (self.file("p.exr"), {"camera": "all"}, psf.Error, "camera: .* of one camera"),
                (self.file("p.exr"), {"camera": (c for c in "ab")}, psf.Error, "camera: .* of one camera")):
            with self.assertRaisesRegex(error, "^" + text):
                psf.render_picture(CORNELL, path, size=(8, 8), passes=1, **settings)
        self.assertEqual(os.listdir(self.folder.name), [])

    def test_names_and_lists_are_taken_as_the_command_takes_them(self) -> None:
        dump = psf.render(Path(CORNELL), Path(self.file("p.pvb")), size=(s for s in (4, 4)), passes=1,
                          channels="normal,hit_distance", image=Path(self.file("p.exr")))
        names = {one.name for one in dump.channels}
        self.assertEqual(names & {"normal", "hit_distance", "visibility"}, {"normal", "hit_distance"})
        psf.render(CORNELL, size=(4, 4), passes=1, image=(self.file(f"{k}.exr") for k in range(2)))
        picture = psf.render_picture(Path(CORNELL), Path(self.file("p.exr")), size=(4, 4), passes=1,
                                     seed=(1 << 63) + 1)
        self.assertEqual((picture.width, len(os.listdir(self.folder.name))), (4, 4))
        for settings, text in ((dict(shade_rate=[[]]), "shade_rate: expected a number"),
                               (dict(size={"w": 4}), "size: expected a number"),
                               (dict(image=[5]), "image: expected a file name"),
                               (dict(output=5), "output: expected a file name"),
                               (dict(scene=None), "scene: expected a file name")):
            with self.assertRaisesRegex(TypeError, "^" + text):
                psf.render(**{"scene": CORNELL, **settings})

    def test_a_render_goes_on(self) -> None:
        path = self.file("a.pvb")
        psf.render(CORNELL, path, size=(8, 8), passes=2)
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            dump = psf.render(CORNELL, path, size=(8, 8), passes=5, resume=True)
        self.assertIn("has 2 of 5 passes", str(said[0].message))
        self.assertEqual(said[0].filename, __file__)
        self.same_dump(dump, psf.render(CORNELL, size=(8, 8), passes=5))

    def test_mistakes_are_one_line(self) -> None:
        for arguments, code, text in (
                (dict(scene="none.json"), 4, "none.json"),
                (dict(passes=0), 2, "passes: expected a whole number from 1"),
                (dict(size=(0, 3)), 2, 'size: expected WxH in pixels'),
                (dict(colour=3), 2, "there is no option 'colour'; there are codec"),
                (dict(camera="nobody"), 2, 'no camera is called "nobody"'),
                (dict(channels="nothing"), 2, "nothing"),
                (dict(output=self.file("a.exr")), 2, "image writes pictures"),
                (dict(output=self.file("none/a.pvb")), 4, "none"),
                (dict(output=CORNELL), 2, "cornell.json")):
            with self.assertRaises(psf.Error) as raised:
                psf.render(**{"scene": CORNELL, **arguments})
            self.assertEqual(raised.exception.code, code, raised.exception)
            self.assertIn(text, str(raised.exception))
            self.assertNotIn("`", str(raised.exception))
            self.assertNotIn("\n", str(raised.exception))

    def test_an_interrupt_ends_a_render_after_its_pass(self) -> None:
        path = self.file("a.pvb")
        started = threading.Event()

        def stop() -> None:
            started.wait()
            os.kill(os.getpid(), signal.SIGINT)

        thread = threading.Thread(target=stop)
        thread.start()
        with self.assertRaises(KeyboardInterrupt):
            psf.render(CORNELL, path, size=(32, 32), passes=1 << 20,
                       progress=lambda done, total: started.set() if done > 1024 else None)
        thread.join()
        kept = psf.open(path)
        self.assertGreater(kept.passes, 0)
        self.assertEqual(kept.records, kept.passes * 32 * 32)

    def test_the_settings_are_the_options_of_the_command(self) -> None:
        said = run("psf-render", "--help")
        settings = psf.render_settings()
        self.assertGreater(len(settings), 20)
        for setting in settings:
            self.assertIn("--" + setting.name.replace("_", "-") + " ", said)
        self.assertEqual({one.name: one.default for one in settings}["passes"], "16")


if __name__ == "__main__":
    unittest.main(argv=["render_test"])
