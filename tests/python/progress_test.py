"""Long calls tell how far they are: to functions, to classes such as tqdm, on terminals and in
notebooks, and ^C ends the call of its own thread alone.

    progress_test.py PACKAGE PROGRAMS SAMPLE_DATA
"""

import io
import os
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

from support import CORNELL, PACKAGE, run

import psf
from psf import _progress


class Terminal(io.StringIO):
    encoding = "utf-8"

    def isatty(self) -> bool:
        return True


class Progress(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = os.path.join(cls.folder.name, "a.pvb")
        run("psf-render", CORNELL, "--size", "32x32", "--quiet", "--passes", "4", "-o", cls.path)
        cls.dump = psf.open(cls.path)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    def calls(self) -> dict:
        """Every long call, with a `progress`."""
        reference = self.dump.filter()
        arrays = {name: self.dump[name][:] for name in
                  ("position", "throughput", "contribution", "pixel", "distance")}
        return {
            "filter": lambda p: self.dump.filter(progress=p),
            "sweep": lambda p: self.dump.sweep(reference, r0=["2px", "4px"], progress=p),
            "tune": lambda p: self.dump.tune(r0=["2px", "4px"], block="1pass", progress=p),
            "explain": lambda p: self.dump.explain((3, 3), progress=p),
            "converge": lambda p: psf.converge([self.dump], reference, r0="4px", progress=p),
            "filter_records": lambda p: psf.filter_records(
                cameras=self.dump.cameras, no_weights=True, progress=p, **arrays),
        }

    def test_every_call_tells_its_end(self) -> None:
        for name, call in self.calls().items():
            seen = []
            call(lambda done, total: seen.append((done, total)))
            self.assertTrue(seen, name)
            self.assertEqual(seen[-1][0], seen[-1][1], name)
            self.assertEqual([done for done, _ in seen], sorted(done for done, _ in seen), name)

    def test_a_class_with_the_methods_of_tqdm_is_a_bar(self) -> None:
        made = []

        class Bar:
            def __init__(self, *, desc: str, total: int, unit: str, unit_scale: bool) -> None:
                self.desc, self.total, self.n, self.closed = desc, total, 0, False
                made.append(self)

            def update(self, n: int) -> None:
                self.n += n

            def close(self) -> None:
                self.closed = True

        for name, call in self.calls().items():
            made.clear()
            call(Bar)
            self.assertEqual([(bar.desc, bar.n, bar.closed) for bar in made],
                             [(name, made[0].total, True)], name)

    def test_a_terminal_gets_one_line_that_is_drawn_again(self) -> None:
        out = Terminal()
        with mock.patch("sys.stderr", out):
            self.dump.filter(block="2^6", progress=True)
        said = out.getvalue()
        self.assertEqual(said.count("\n"), 1)
        last = said.rstrip("\n").split("\r")[-1].removesuffix("\033[K")
        self.assertRegex(last, r"^filter: 100%\|█+\| 4.1k/4.1k \[\d\d:\d\d<00:00, [\d.e+]+[kMG]?path/s\]$")
        self.assertLess(len(last), 80)

    def test_elsewhere_a_short_call_says_nothing(self) -> None:
        out = io.StringIO()
        with mock.patch("sys.stderr", out):
            self.dump.filter(progress=True)
            self.dump.filter(progress=False)
            self.dump.filter()
        self.assertEqual(out.getvalue(), "")

    def test_a_long_call_says_a_line_now_and_then(self) -> None:
        out, now = io.StringIO(), 0.0
        with mock.patch("sys.stderr", out), mock.patch("time.monotonic", lambda: now):
            bar = _progress.Bar("work", 1000)
            for _ in range(100):
                now += 0.5
                bar.update(10)
            bar.close()
        lines = out.getvalue().splitlines()
        self.assertEqual(len(lines), 6)  # every 10 of 50 seconds, and the end
        self.assertTrue(lines[1].endswith("| 400/1k [00:20<00:30, 20it/s]"), lines[1])

    def test_a_notebook_shows_one_output_that_is_updated(self) -> None:
        shown, updated, now = [], [], 0.0

        class Handle:
            def update(self, data: dict, raw: bool) -> None:
                updated.append(data["text/plain"])

        def display(data: dict, raw: bool, display_id: bool) -> Handle:
            shown.append(data["text/plain"])
            return Handle()

        with mock.patch.object(_progress, "_notebook", lambda: display), \
                mock.patch("time.monotonic", lambda: now):
            with _progress.shown(None, "work") as report:
                for k in range(51):
                    report(k, 50)
                    now += 0.05
            with _progress.shown(None, "moment") as report:
                report(1, 1)
        self.assertEqual(len(shown), 1)  # the second took no longer than a moment
        self.assertIn("100%", updated[-1])
        self.assertTrue(all(line.startswith("work: ") for line in shown + updated))

    def test_the_time_runs_from_the_call(self) -> None:
        out, now = Terminal(), 0.0

        class Tqdm:
            def __init__(self, **arguments: object) -> None:
                self.start_t = 1000.0
                starts.append(self)

            def update(self, n: int) -> None:
                pass

            def close(self) -> None:
                pass

        starts = []
        with mock.patch("sys.stderr", out), mock.patch("time.monotonic", lambda: now):
            for progress in (True, Tqdm):
                with _progress.shown(progress, "work") as report:
                    now += 30
                    report(5, 10)
        self.assertIn("[00:30<00:30, ", out.getvalue())
        self.assertEqual(starts[0].start_t, 970)

    def test_without_a_console_a_bar_says_nothing(self) -> None:
        now = 0.0
        with mock.patch("sys.stderr", None), mock.patch("time.monotonic", lambda: now):
            with _progress.shown(True, "work") as report:
                for k in range(4):
                    now += 20
                    report(k, 3)

    def test_numbers_are_short(self) -> None:
        for count, text in ((0, "0"), (999, "999"), (1000, "1k"), (1048576, "1.05M"),
                            (65536, "65.5k"), (999999, "1M"), (2.5e9, "2.5G"), (1e12, "1T")):
            self.assertEqual(_progress._scaled(count), text)
        self.assertEqual([_progress._clock(s) for s in (0.4, 73, 3601)], ["00:00", "01:13", "1:00:01"])

    def test_an_interrupt_leaves_the_calls_of_other_threads(self) -> None:
        """The main thread's call ends, and another thread's, begun before it, comes to its end."""
        program = """
import os, signal, sys, threading
sys.path.insert(0, sys.argv[1])
import psf
dump = psf.open(sys.argv[2])
hard = dict(block="2^6", r0="64px", no_weights=True, iterations=3)
running, release = threading.Event(), threading.Event()
ended = []

def other():
    def progress(done, total):
        running.set()
        release.wait()
    try:
        dump.filter(progress=progress, **hard)
        ended.append("well")
    except BaseException as error:
        ended.append(type(error).__name__)

thread = threading.Thread(target=other)
thread.start()
running.wait()
try:
    threading.Timer(0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    while True:
        dump.filter(**hard)
except KeyboardInterrupt:
    print("interrupted")
release.set()
thread.join()
print(*ended)
dump.filter()
"""
        said = subprocess.run([sys.executable, "-B", "-c", program, PACKAGE, self.path],
                              capture_output=True, text=True)
        self.assertEqual((said.stdout, said.returncode), ("interrupted\nwell\n", 0), said.stderr)


if __name__ == "__main__":
    unittest.main(argv=["progress_test"])
