"""Progress of long calls, in the way of tqdm: a bar, a function, or a class such as tqdm itself."""

from __future__ import annotations

import contextlib
import importlib
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any, TextIO, Union

# True: a bar; False: none; None: a bar in a notebook, for what takes longer than a moment; a
# function of what is done and of all there is; or a class with tqdm's arguments and methods.
Progress = Union[bool, None, Callable[[int, int], object], type]

_MOMENT = 0.5  # seconds before a bar that nobody asked for shows
_REDRAW = 0.1  # seconds between two drawings
_LOG = 10.0  # seconds between two lines where stderr is neither a terminal nor a notebook


def _scaled(count: float) -> str:
    for unit in ("", "k", "M", "G"):
        if count < 999.5:
            return f"{count:.3g}{unit}"
        count /= 1000
    return f"{count:.3g}T"


def _clock(seconds: float) -> str:
    minutes, whole = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{whole:02}" if hours else f"{minutes:02}:{whole:02}"


def _notebook() -> Any:
    """What shows and updates an output of the notebook that runs this, if one does."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is None or not hasattr(shell, "kernel"):
        return None
    return importlib.import_module("IPython.display").display


class Bar:
    """A bar with the arguments and methods of tqdm's that are needed here."""

    def __init__(self, desc: str, total: int, unit: str = "it", unit_scale: bool = True,
                 delay: float = 0, start: float | None = None) -> None:
        self._desc, self._total, self._unit = desc, total, unit
        self._n, self._start = 0, time.monotonic() if start is None else start
        self._out: TextIO | None = sys.stderr  # None where there is no console
        self._display, self._shown = _notebook(), None
        self._terminal = self._display is None and self._out is not None and self._out.isatty()
        self._between = _REDRAW if self._display is not None or self._terminal else _LOG
        self._next = self._start + max(delay, 0 if self._terminal or self._display else _LOG)
        self._drawn = False

    def update(self, n: int) -> None:
        self._n += n
        now = time.monotonic()
        if now >= self._next:
            self._next = now + self._between
            self._draw()

    def close(self) -> None:
        """Leaves the last line there, as it is."""
        if self._drawn:
            self._draw()
            if self._terminal and self._out is not None:
                self._out.write("\n")
        self._drawn = False

    def line(self, width: int) -> str:
        elapsed = time.monotonic() - self._start
        part = self._n / self._total if self._total else 1.0
        rate = self._n / elapsed if elapsed > 0 else 0.0
        left = _clock((self._total - self._n) / rate) if rate > 0 else "?"
        speed = _scaled(rate) if rate > 0 else "?"
        before = f"{self._desc}: {100 * part:3.0f}%|"
        after = (f"| {_scaled(self._n)}/{_scaled(self._total)} "
                 f"[{_clock(elapsed)}<{left}, {speed}{self._unit}/s]")
        room = max(0, min(width - len(before) - len(after), 40))
        eighths = round(8 * room * part)
        full, rest = divmod(eighths, 8)
        bar = "█" * full + (" ▏▎▍▌▋▊▉"[rest] if rest else "")
        try:
            bar.encode("utf-8" if self._out is None else self._out.encoding or "ascii")
        except UnicodeError:
            bar = "#" * full
        return before + bar.ljust(room) + after

    def _draw(self) -> None:
        self._drawn = True
        if self._display is not None:
            show = {"text/plain": self.line(100)}
            if self._shown is None:
                self._shown = self._display(show, raw=True, display_id=True)
            else:
                self._shown.update(show, raw=True)
            return
        if self._out is None:
            return
        line = self.line(shutil.get_terminal_size().columns - 1 if self._terminal else 100)
        self._out.write(f"\r{line}\033[K" if self._terminal else line + "\n")
        self._out.flush()


@contextlib.contextmanager
def shown(progress: Progress, what: str) -> Iterator[Callable[[int, int], object] | None]:
    """The function that a call reports to, while it runs."""
    if progress is False or (progress is None and _notebook() is None):
        yield None
        return
    if callable(progress) and not isinstance(progress, type):
        yield progress
        return
    bar: Any = None
    before, start = 0, time.monotonic()

    def report(done: int, total: int) -> None:
        nonlocal bar, before
        if bar is None:
            if isinstance(progress, type):
                bar = progress(desc=what, total=total, unit="path", unit_scale=True)
                if hasattr(bar, "start_t"):  # tqdm's, by a clock of its own
                    bar.start_t -= time.monotonic() - start
            else:
                bar = Bar(what, total, "path", delay=_MOMENT if progress is None else 0,
                          start=start)
        bar.update(done - before)
        before = done

    try:
        yield report
    finally:
        if bar is not None:
            bar.close()
