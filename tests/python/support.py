"""What the tests of the package share: they are called as NAME_test.py PACKAGE PROGRAMS SAMPLE_DATA."""

import os
import subprocess
import sys

PACKAGE, PROGRAMS, SAMPLES = sys.argv[1:4]
sys.path.insert(0, PACKAGE)

CORNELL = os.path.join(SAMPLES, "cornell.json")


def run(*command: str) -> str:
    command = (os.path.join(PROGRAMS, command[0]),) + command[1:]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def content(path: str) -> bytes:
    with open(path, "rb") as file:
        return file.read()
