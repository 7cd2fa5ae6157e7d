"""Vertices in volumes, against an average written with numpy; arrays and dumps give the same.

    kinds_test.py PACKAGE PROGRAMS SAMPLE_DATA
"""

import json
import os
import sys
import tempfile
import unittest
from typing import Any

import numpy as np

from support import CORNELL, PROGRAMS, run

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "formats"))

import pvb

import psf

SIDE, COUNT = 16, 512  # two records a pixel: one pass of a dump
CAMERA = psf.Camera("", SIDE, SIDE, 0.02)
RADIUS, NORMAL, REFLECTANCE, PLANE = 0.25, 0.9, 0.1, 0.5


def make_records() -> dict[str, Any]:
    """Random records of surfaces, curves and volumes, which have no normal, in one cube."""
    random = np.random.default_rng(3)
    angle = random.integers(0, 5, COUNT) * 0.3
    records = {
        "position": random.random((COUNT, 3)), "throughput": random.random((COUNT, 3)),
        "contribution": random.random((COUNT, 3)) * 4, "distance": np.ones(COUNT),
        "unfiltered": random.random((COUNT, 3)), "pixel": np.arange(COUNT) % (SIDE * SIDE),
        "normal": np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1),
        "reflectance": random.choice([0.2, 0.25, 0.5], (COUNT, 3)),
        "visibility": random.integers(0, 2, COUNT), "kind": random.integers(0, 3, COUNT)}
    records["normal"][records["kind"] == 2] = random.choice([0, np.nan], 3 * COUNT).reshape(
        COUNT, 3)[records["kind"] == 2]
    types = {"pixel": np.uint32, "visibility": np.uint32, "kind": np.uint8}
    return {name: values.astype(types.get(name, np.float32)) for name, values in records.items()}


def estimate(records: dict[str, Any]) -> tuple[Any, Any]:
    """c_bar and the number of neighbours of every record, in double."""
    x, n, rho = (records[name].astype(np.float64) for name in ("position", "normal", "reflectance"))
    volume = records["kind"] == 2
    average, count = np.zeros((COUNT, 3)), np.zeros(COUNT, dtype=int)
    for i in range(COUNT):
        offset = x - x[i]
        near = ((offset**2).sum(axis=1) < RADIUS**2) & (volume == volume[i])
        near &= records["visibility"] == records["visibility"][i]
        if not volume[i]:
            with np.errstate(invalid="ignore"):
                near &= n @ n[i] >= NORMAL
            near &= np.sqrt(((rho - rho[i])**2).sum(axis=1)) <= REFLECTANCE
            near &= np.abs(offset @ n[i]) <= PLANE * RADIUS
        near[i] = True
        count[i] = near.sum()
        average[i] = records["contribution"][near].astype(np.float64).mean(axis=0)
    return average, count


TERMS = {"r0": f"{RADIUS}wu", "delta": 0, "normal": NORMAL, "reflectance": REFLECTANCE,
         "plane": PLANE, "visibility": True, "block": "all"}


class Kinds(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.records = make_records()
        cls.path = os.path.join(cls.folder.name, "kinds.pvb")
        shapes = {name: (values.dtype.str[1:], 3) if values.ndim == 2 else values.dtype.str[1:]
                  for name, values in cls.records.items()}
        with psf.create(cls.path, [CAMERA], shapes) as writer:
            writer.append(**cls.records)
            writer.commit_pass()

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    def filtered(self, **parameters: Any) -> Any:
        return psf.filter_records(cameras=[CAMERA], parameters={**TERMS, **parameters},
                                  no_weights=True, **self.records)

    def test_every_search_finds_the_neighbours_that_numpy_finds(self) -> None:
        average, count = estimate(self.records)
        volume = self.records["kind"] == 2
        self.assertGreater(count[volume].mean(), 2)
        self.assertGreater(count[~volume].mean(), 1.2)
        for search in ("flann", "plain", "brute"):
            found = self.filtered(search=search)
            self.assertTrue(np.array_equal(found.neighbors, count), search)
            self.assertTrue(np.allclose(found.c_bar, average, rtol=1e-5, atol=1e-6), search)

    def test_a_dump_gives_the_picture_of_the_arrays(self) -> None:
        dump = psf.open(self.path)
        for estimator in ("average", "adaptive", "control", "hash"):
            terms = {"estimator": estimator, **({"plane": None} if estimator == "hash" else {})}
            expected = self.filtered(**terms).pictures[0]
            picture = dump.filter(no_weights=True, **{**TERMS, **terms})
            self.assertTrue(np.array_equal(picture.rgb, expected.rgb, equal_nan=True), estimator)

    def test_the_radii_of_a_sweep_are_runs_of_their_own(self) -> None:
        dump = psf.open(self.path)
        reference = dump.filter(r0="1wu", no_weights=True)
        rows = dump.sweep(reference, no_weights=True, **{**TERMS, "r0": ["0.1wu", "0.25wu"]})
        for row in rows:
            alone = dump.filter(no_weights=True, **{**TERMS, "r0": row["r0"]})
            self.assertAlmostEqual(row["relMSE"] / alone.error(reference), 1, 4)

    def test_explain_names_what_keeps_kinds_apart(self) -> None:
        i = int(np.argmax(self.records["kind"] == 2))
        options = [f"--{name}={value}" for name, value in TERMS.items() if name != "visibility"]
        figures = os.path.join(self.folder.name, "e.json")
        said = run("psf", "explain", self.path, "--path", str(i), "--no-weights", *options,
                   "--visibility", "--json", figures)
        with open(figures, encoding="utf-8") as file:
            explained = json.load(file)
        path = explained["paths"][0]
        self.assertEqual(path["kind"], "volume")
        self.assertIn("1 of a volume", said)
        x = self.records["position"].astype(np.float64)
        near = ((x - x[i])**2).sum(axis=1) < RADIUS**2
        apart = near & (self.records["kind"] != 2)
        self.assertGreater(apart.sum(), 3)
        refusals = {of["term"]: of["refused"] for of in explained["refusals"]}
        self.assertEqual(refusals["kind"], apart.sum())
        self.assertEqual(refusals["normal"], 0)
        self.assertEqual(path["in_ball"], near.sum())
        averaged = [number for number, is_averaged
                    in zip(path["neighbors"]["record"], path["neighbors"]["averaged"]) if is_averaged]
        self.assertEqual(set(self.records["kind"][averaged]), {2})
        self.assertEqual(path["averaged"], len(averaged))
        self.assertEqual(path["averaged"], self.filtered().neighbors[i])

    def test_explained_fits_and_fireflies_add_up_in_volumes_too(self) -> None:
        records = {**self.records, "contribution": self.records["contribution"].copy()}
        # Few that are alike, since of what is bright everywhere nothing is a firefly.
        for kind, step in ((0, 8), (1, 8), (2, 80)):
            records["contribution"][np.flatnonzero(records["kind"] == kind)[::step]] *= 60
        path = os.path.join(self.folder.name, "bright.pvb")
        shapes = {name: (values.dtype.str[1:], 3) if values.ndim == 2 else values.dtype.str[1:]
                  for name, values in records.items()}
        with psf.create(path, [CAMERA], shapes) as writer:
            writer.append(**records)
            writer.commit_pass()
        terms = {**TERMS, "r0": "0.8wu", "fit": "linear", "fireflies": "spread", "search": "brute"}
        c_bar = psf.filter_records(cameras=[CAMERA], parameters=terms, no_weights=True,
                                   **records).c_bar
        dump, fitted, given = psf.open(path), [0, 0, 0], [0, 0, 0]
        for i in range(0, COUNT, 8):
            explained = dump.explain(path=i, no_weights=True, **terms)["paths"][0]
            kind, of = records["kind"][i], explained["neighbors"]
            kept, part = (np.array(of[name])[:, np.newaxis] for name in ("kept", "given"))
            light = np.array(of["contribution"])
            total = (np.array(of["weight"]) * kept * light + part * light).sum(axis=0)
            self.assertTrue(np.allclose(total, c_bar[i], rtol=1e-5, atol=1e-6), i)
            fitted[kind] += explained["fit"] is not None
            given[kind] += bool((part > 0).any())
            brings = np.array(of["averaged"]) | (part[:, 0] > 0)
            volume = records["kind"][np.array(of["record"])[brings]] == 2
            self.assertTrue((volume == (kind == 2)).all(), i)
        self.assertGreater(min(fitted), 3)
        self.assertGreater(min(given), 1, given)

    @unittest.skipUnless(os.path.exists(os.path.join(PROGRAMS, "psf-render")), "no renderer")
    def test_the_vertex_that_is_chosen_brings_its_kind(self) -> None:
        """Of paths without the channel, whose vertices have one."""
        plain, path = (os.path.join(self.folder.name, name) for name in ("plain.pvb", "of.pvb"))
        run("psf-render", CORNELL, "--size", f"{SIDE}x{SIDE}", "--passes", "2", "--vertices", "all",
            "--quiet", "-o", plain)
        random = np.random.default_rng(5)
        neighbors, queries = np.zeros((2, SIDE * SIDE))
        with pvb.open(plain) as dump:
            table = dump.tables["vertices"]
            more = [*table.channels.values(), pvb.Channel("kind", "u8")]
            x, pixel, volume = [], [], []
            with pvb.create(path, dump.channels.values(), dump.metadata,
                            tables={"vertices": more}) as writer:
                for k in range(2):
                    paths, rows = dump.pass_range(k), table.pass_range(k)
                    columns = {name: table.read(name, *rows) for name in table.channels}
                    columns["kind"] = random.integers(0, 3, len(columns["path"])).astype(np.uint8)
                    writer.append({name: dump.read(name, *paths) for name in dump.channels})
                    writer.append_to("vertices", columns)
                    writer.commit()
                    second = np.flatnonzero((columns["parent"] == 1)
                                            & (np.roll(columns["parent"], 1) == 0))
                    x.append(columns["position"][second].astype(np.float64))
                    volume.append(columns["kind"][second] == 2)
                    pixel.append(dump.read("pixel", *paths)[columns["path"][second]])
        x, volume, pixel = (np.concatenate(parts) for parts in (x, volume, pixel))
        for i, at in enumerate(x):
            near = (((x - at)**2).sum(axis=1) < 0.5**2) & (volume == volume[i])
            neighbors[pixel[i]] += near.sum()
            queries[pixel[i]] += 1
        picture = psf.open(path).filter(vertex="depth:1", no_weights=True, r0="0.5wu", delta=0,
                                        block="all")
        expected = neighbors / np.maximum(queries, 1)
        self.assertTrue(np.allclose(picture.neighbors.ravel(), expected, rtol=1e-6))
        self.assertGreater(expected.max(), 20)
        texts = [psf.open(path).explain((k, 8), vertex="depth:1", visibility=False).text()
                 for k in range(6)]
        self.assertTrue(any("of a volume" in text for text in texts))
        self.assertTrue((psf.open(path).filter().rgb == psf.open(plain).filter().rgb).all())


if __name__ == "__main__":
    unittest.main(argv=[__file__])
