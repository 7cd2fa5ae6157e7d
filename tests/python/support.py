"""What the tests of the package share: they are called as NAME_test.py PACKAGE PROGRAMS SAMPLE_DATA."""

import os
import signal
import subprocess
import sys
import threading
import time
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


def assert_interrupted(case: unittest.TestCase, call: Callable[[], object]) -> None:
    """^C ends the call, and other threads of Python run beside it."""
    ticks = []

    def tick() -> None:
        for _ in range(20):
            ticks.append(time.monotonic())
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=tick)
    thread.start()
    with case.assertRaises(KeyboardInterrupt):
        while True:  # whatever the machine: it is at work when the signal comes
            call()
    thread.join()
    case.assertEqual(len(ticks), 20)
