"""--estimator density, against the estimate written with numpy from the dump's two tables.

    density_test.py PACKAGE PROGRAMS SAMPLE_DATA
"""

import os
import sys
import tempfile
import unittest
import warnings
from typing import Any

import numpy as np

from support import PROGRAMS, SAMPLES, assert_refused, run

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "formats"))

import pvb

import psf

if not os.path.exists(os.path.join(PROGRAMS, "psf-render")):
    print("skipped: built without the renderer")
    sys.exit(77)

SIDE, PASSES = 24, 4


class Tree:
    """A kd-tree over points, cut at the median of the longest side, leaf by leaf in numpy."""

    LEAF = 64

    def __init__(self, points: Any, numbers: Any) -> None:
        self.points, self.numbers = points, numbers
        self.low, self.high = points.min(axis=0), points.max(axis=0)
        self.parts: tuple[Tree, ...] = ()
        if len(points) <= self.LEAF:
            return
        order = np.argsort(points[:, np.argmax(self.high - self.low)], kind="stable")
        half = len(points) // 2
        self.parts = (Tree(points[order[:half]], numbers[order[:half]]),
                      Tree(points[order[half:]], numbers[order[half:]]))

    def within(self, center: Any, radius: float) -> Any:
        outside = np.maximum(np.maximum(self.low - center, center - self.high), 0)
        if outside @ outside >= radius * radius:
            return self.numbers[:0]
        if self.parts:
            return np.concatenate([part.within(center, radius) for part in self.parts])
        return self.numbers[((self.points - center) ** 2).sum(axis=1) < radius * radius]


def estimate(path: str, radius: float, delta: float, block: int, cosine: float) -> Any:
    """The picture of [density] and the mean number of photons of its queries: world units."""
    with pvb.open(path) as dump:
        table = dump.tables["photons"]
        pixels, count = np.zeros((SIDE * SIDE, 3)), np.zeros(SIDE * SIDE)
        found, queries = np.zeros(SIDE * SIDE), np.zeros(SIDE * SIDE)
        for first in range(0, dump.passes, block):
            last = min(first + block, dump.passes)
            rows = [table.pass_range(k) for k in range(first, last)]
            photon = {name: np.concatenate([table.read(name, *r) for r in rows]).astype(np.float64)
                      for name in ("position", "normal", "direction", "power")}
            tree = Tree(photon["position"], np.arange(len(photon["position"])))
            r = radius / np.sqrt(last**delta)
            for k in range(first, last):
                path_of = {name: dump.read(name, *dump.pass_range(k)).astype(np.float64)
                           for name in ("position", "normal", "reflectance", "throughput",
                                        "unfiltered", "flags", "pixel")}
                for i, pixel in enumerate(path_of["pixel"].astype(int)):
                    value = path_of["unfiltered"][i]
                    if int(path_of["flags"][i]) & 1:
                        normal = path_of["normal"][i]
                        near = tree.within(path_of["position"][i], r)
                        near = near[(photon["normal"][near] @ normal >= cosine)
                                    & (photon["direction"][near] @ normal > 0)]
                        found[pixel] += len(near)
                        queries[pixel] += 1
                        flux = photon["power"][near].sum(axis=0) / (np.pi * r * r) / (last - first)
                        value = value + (path_of["throughput"][i] * path_of["reflectance"][i]
                                         / np.pi * flux)
                    pixels[pixel] += value
                    count[pixel] += 1
    neighbors = found / np.maximum(queries, 1)
    return (pixels / count[:, None]).reshape(SIDE, SIDE, 3), neighbors.reshape(SIDE, SIDE)


class Density(unittest.TestCase):
    folder: tempfile.TemporaryDirectory[str]
    path: str

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.path = os.path.join(cls.folder.name, "caustic.pvb")
        run("psf-render", os.path.join(SAMPLES, "caustic.json"), "--size", f"{SIDE}x{SIDE}",
            "--passes", str(PASSES), "--photons", "20000", "-o", cls.path, "--quiet")

    def test_pixels_are_those_of_numpy(self) -> None:
        for delta, block in ((0.5, 1), (0.0, 3)):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of the weights that are off
                picture = psf.open(self.path).filter(estimator="density", r0="0.15wu", delta=delta,
                                                     block=f"{block}passes", normal=0.95)
            expected, neighbors = estimate(self.path, 0.15, delta, block, 0.95)
            # A photon on the sphere or at the threshold may fall to either side in float.
            found = float(np.mean(picture.neighbors, where=neighbors > 0))
            self.assertAlmostEqual(found / float(neighbors[neighbors > 0].mean()), 1, delta=1e-4)
            off = np.abs(picture.rgb - expected) / (expected + 1e-3)
            self.assertLess(float(np.quantile(off, 0.99)), 1e-5)
            self.assertLess(float(off.max()), 0.02)
            self.assertGreater(float(expected.mean()), 0.01)

    def test_what_records_cannot_give_is_refused(self) -> None:
        dump = psf.open(self.path)
        assert_refused(self, lambda: dump.filter(estimator="density", reflectance=0.1), 2,
                       "photons of estimator density have nothing")
        with self.assertWarnsRegex(UserWarning, "photons cannot tell"):
            dump.filter(estimator="density")


if __name__ == "__main__":
    unittest.main(argv=["density_test"])
