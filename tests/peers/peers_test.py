"""Each denoiser gets the files that it takes, and its picture is what is measured: programs in their place copy their
input, so that their columns are those of no filter. Whoever is not there, or fails, is named."""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

RUN = Path(__file__).resolve().parent / "run"

# Each checks that all it takes is there, and copies the colours.
FAKES = {
    "oidn": """
options = dict(zip(sys.argv[1::2], sys.argv[2::2]))
assert sorted(options) == ["--alb", "--hdr", "--nrm", "-o"], options
for name in ("--alb", "--hdr", "--nrm"):
    assert open(options[name], "rb").read(3) == b"PF\\n", name
shutil.copy(options["--hdr"], options["-o"])
""",
    "nfor": """
scene, output = sys.argv[1:]
buffers = json.load(open(scene))["renderer"]["output_buffers"]
assert [buffer["type"] for buffer in buffers] == ["color", "depth", "albedo", "normal"]
for buffer in buffers:
    stem, ending = buffer["hdr_output_file"].split(".")
    for part in ("", "A", "B", "Variance"):
        assert os.path.exists(f"{stem}{part}.{ending}"), stem + part
shutil.copy("color.exr", output)
""",
    "bcd": """
options = dict(zip(sys.argv[1::2], sys.argv[2::2]))
assert sorted(options) == ["--use-cuda", "-c", "-h", "-i", "-o"], options
assert os.path.exists(options["-h"]) and os.path.exists(options["-c"])
shutil.copy(options["-i"], options["-o"])
""",
}


def write_fake(path, body):
    path.write_text(f"#!/usr/bin/env python3\nimport json, os, shutil, sys\n{body}")
    path.chmod(0o755)
    return str(path)


def run(folder, programs, *arguments):
    command = [RUN, folder / "out", "cornell", "--size", "24x24", "--passes", "2,4", "--reference-passes", "8",
               "--bin", programs, *arguments]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done, json.loads((folder / "out/peers.json").read_text())


def test_absent(folder, programs):
    """The rows of psf are there without any other denoiser."""
    absent = [word for peer in FAKES for word in (f"--{peer}", "/nowhere/program")]
    done, report = run(folder, programs, *absent, "--psf", "wide=--r0 16px")
    for peer in FAKES:
        assert f"{peer}: /nowhere/program not found, skipped\n" in done.stderr
    assert "| scene | passes | no filter | psf | wide |" in done.stdout
    assert [row["passes"] for row in report] == [2, 4]
    for row in report:
        assert list(row["results"]) == ["no filter", "psf", "wide"]
        errors = [way["relMSE"] for way in row["results"].values()]
        assert errors[0] > errors[1] > 0 and errors[2] != errors[1]


def test_copies(folder, programs):
    """What copies its input is as good as no filter."""
    fakes = [word for peer, body in FAKES.items()
             for word in (f"--{peer}", write_fake(folder / f"fake_{peer}", body))]
    done, report = run(folder, programs, *fakes)
    assert "skipped" not in done.stderr, done.stderr
    assert "| scene | passes | no filter | psf | oidn | nfor | bcd |" in done.stdout
    for row in report:
        results = row["results"]
        for peer in FAKES:
            for metric in ("relMSE", "FLIP", "SSIM"):
                assert abs(results[peer][metric] / results["no filter"][metric] - 1) < 1e-6, (peer, metric)
    assert "rendering" not in done.stderr  # the first test did


def test_failing(folder, programs):
    """A denoiser that fails is named, and has a dash in place of its figures."""
    fake = write_fake(folder / "failing", "sys.exit('no memory')")
    absent = ["--oidn", "/nowhere/program", "--bcd", "/nowhere/program"]
    done, report = run(folder, programs, "--nfor", fake, *absent)
    assert "cornell, 2 passes: nfor: failing ended with 1: no memory\n" in done.stderr
    assert all("nfor" not in row["results"] for row in report)
    assert [line for line in done.stdout.splitlines() if line.startswith("| cornell | 2 |") and line.endswith("| - |")]


def main():
    programs = Path(sys.argv[1]).resolve()
    if not shutil.which("oiiotool"):
        print("there is no oiiotool, which reads what oidnDenoise writes")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as name:
        for test in (test_absent, test_copies, test_failing):
            test(Path(name), programs)


if __name__ == "__main__":
    main()
