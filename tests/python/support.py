"""What the tests of the package share: they are called as NAME_test.py PACKAGE PROGRAMS SAMPLE_DATA."""

import os
import subprocess
import sys
import unittest
from collections.abc import Callable

PACKAGE, PROGRAMS, SAMPLES = sys.argv[1:4]
sys.path.insert(0, PACKAGE)

import psf  # it is in that folder

CORNELL = os.path.join(SAMPLES, "cornell.json")


def run(*command: str) -> str:
    command = (os.path.join(PROGRAMS, command[0]),) + command[1:]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def content(path: str) -> bytes:
    with open(path, "rb") as file:
        return file.read()


def assert_refused(case: unittest.TestCase, call: Callable[[], object], code: int, text: str) -> None:
    """The call is an error of this code, in one line that has the text."""
    with case.assertRaises(psf.Error) as raised:
        call()
    case.assertEqual(raised.exception.code, code, raised.exception)
    case.assertIn(text, str(raised.exception))
    case.assertNotIn("\n", str(raised.exception))
    case.assertNotIn("`", str(raised.exception))
