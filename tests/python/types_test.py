"""The types of the package and of programs that use it are complete: mypy --strict finds nothing.

    types_test.py PACKAGE PROGRAMS SAMPLE_DATA
"""

import os
import shutil
import subprocess
import sys

if shutil.which("mypy") is None:
    print("skipped: no mypy here")
    sys.exit(77)
here = os.path.dirname(os.path.abspath(__file__))
environment = dict(os.environ, MYPYPATH=sys.argv[1])
sys.exit(subprocess.run(
    ["mypy", "--strict", "--python-version", "3.11", "--cache-dir", os.devnull, "-p", "psf",
     ], env=environment).returncode or subprocess.run(
    ["mypy", "--strict", "--python-version", "3.11", "--cache-dir", os.devnull,
     os.path.join(here, "example.py"), os.path.join(here, "frames_example.py")],
    env=environment).returncode)
