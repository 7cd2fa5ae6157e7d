"""The notebooks in sample_data run from the first cell to the last, and show what they say.

    notebook_test.py PACKAGE PROGRAMS SAMPLE_DATA [FOLDER_FOR_FIGURES]
"""

from __future__ import annotations

import base64
import os
import sys
import unittest
from typing import Any

try:
    import matplotlib  # noqa: F401
    import nbclient
    import nbformat
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

from support import PACKAGE, SAMPLES

# What the prose of each claims, of the variables that its cells leave.
RADIUS = """
assert best[1] > best[4] > best[16], best
for n in passes:
    assert 0 < errors[n].argmin() < len(radii) - 1, (n, errors[n])  # a valley, not a slope
assert errors[1].min() > errors[4].min() > errors[16].min()
at = list(radii).index(tuning.best["r0"])
assert errors[16][at] < 1.15 * errors[16].min(), (tuning.best["r0"], best[16])
"""
SHADING = """
for scene, rows in results.items():
    shade, split, more = ([error for _, error in points] for points in rows.values())
    assert shade == sorted(shade), (scene, shade)
    assert split[0] == shade[0] == more[2], (scene, "the same render")
    assert split[1] < split[0], (scene, split)
    assert more == sorted(more, reverse=True), (scene, more)
"""


def outputs_of(name: str, claims: str) -> list[Any]:
    """What the cells of a notebook put out; raises where a cell or a claim does."""
    notebook = nbformat.read(os.path.join(SAMPLES, name), as_version=4)
    nbformat.validate(notebook)
    if any(cell.get("outputs") for cell in notebook.cells):
        raise AssertionError(f"{name} is stored with outputs")
    notebook.cells.append(nbformat.v4.new_code_cell(claims))
    client = nbclient.NotebookClient(notebook, timeout=None, kernel_name="python3",
                                     resources={"metadata": {"path": SAMPLES}})
    client.execute()
    return [output for cell in notebook.cells for output in cell.get("outputs", [])]


class Notebooks(unittest.TestCase):
    def check(self, name: str, claims: str, pictures: int) -> None:
        before = sorted(os.listdir(SAMPLES))
        outputs = outputs_of(name, claims)
        self.assertEqual(sorted(os.listdir(SAMPLES)), before)
        self.assertEqual([o["text"] for o in outputs if o.get("name") == "stderr"], [])
        shown = [base64.b64decode(o["data"]["image/png"]) for o in outputs
                 if "image/png" in o.get("data", {})]
        self.assertEqual(len(shown), pictures)
        self.assertTrue(all(png.startswith(b"\x89PNG") for png in shown))
        bars = [o["data"]["text/plain"] for o in outputs if "path/s]" in str(o.get("data", {}))]
        self.assertTrue(all("100%" in bar for bar in bars), bars)
        if len(sys.argv) > 4:
            with open(os.path.join(sys.argv[4], name.replace(".ipynb", ".png")), "wb") as file:
                file.write(shown[-1])

    def test_error_over_the_radius(self) -> None:
        self.check("error-over-r0.ipynb", RADIUS, pictures=2)  # the filtered one, and the figure

    def test_shading_rates_and_splitting(self) -> None:
        self.check("shading-rate.ipynb", SHADING, pictures=1)


if __name__ == "__main__":
    os.environ["PYTHONPATH"] = PACKAGE
    unittest.main(argv=["notebook_test"])
