"""The notebook in sample_data runs from its first cell to its last, and shows what it says.

    notebook_test.py PACKAGE PROGRAMS SAMPLE_DATA [FIGURE.png]
"""

import base64
import os
import sys
import unittest

try:
    import matplotlib  # noqa: F401
    import nbclient
    import nbformat
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

from support import PACKAGE, SAMPLES

# What the prose claims, of the variables that the cells leave.
CLAIMS = """
assert best[1] > best[4] > best[16], best
for n in passes:
    assert 0 < errors[n].argmin() < len(radii) - 1, (n, errors[n])  # a valley, not a slope
assert errors[1].min() > errors[4].min() > errors[16].min()
at = list(radii).index(tuning.best["r0"])
assert errors[16][at] < 1.15 * errors[16].min(), (tuning.best["r0"], best[16])
"""


class Notebook(unittest.TestCase):
    def test_the_notebook_shows_what_it_says(self) -> None:
        path = os.path.join(SAMPLES, "error-over-r0.ipynb")
        notebook = nbformat.read(path, as_version=4)
        nbformat.validate(notebook)
        for cell in notebook.cells:
            self.assertFalse(cell.get("outputs"), "stored without outputs")
        notebook.cells.append(nbformat.v4.new_code_cell(CLAIMS))
        os.environ["PYTHONPATH"] = PACKAGE
        before = sorted(os.listdir(SAMPLES))
        client = nbclient.NotebookClient(notebook, timeout=None, kernel_name="python3",
                                         resources={"metadata": {"path": SAMPLES}})
        client.execute()  # raises where a cell does
        self.assertEqual(sorted(os.listdir(SAMPLES)), before)
        outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        self.assertEqual([o["text"] for o in outputs if o.get("name") == "stderr"], [])
        pictures = [base64.b64decode(o["data"]["image/png"]) for o in outputs
                    if "image/png" in o.get("data", {})]
        self.assertEqual(len(pictures), 2)  # the filtered picture, and the figure
        self.assertTrue(all(png.startswith(b"\x89PNG") for png in pictures))
        bars = [o["data"]["text/plain"] for o in outputs if "path/s]" in str(o.get("data", {}))]
        self.assertTrue(all("100%" in bar for bar in bars), bars)
        if len(sys.argv) > 4:
            with open(sys.argv[4], "wb") as file:
                file.write(pictures[-1])


if __name__ == "__main__":
    unittest.main(argv=["notebook_test"])
