"""What studies give: the figures of the commands' JSON, rows for tables, and files."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Union

from psf import _psf
from psf._picture import Picture, read_picture
from psf._progress import Progress, shown
from psf._values import Value, lists, with_underscores

if TYPE_CHECKING:
    from psf._dump import Dump


class Figures(Mapping[str, Any]):
    """The figures that the command writes with ``--json``, by the same names: a mapping."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._loaded: dict[str, Any] | None = None

    def _figures(self) -> dict[str, Any]:
        if self._loaded is None:
            self._loaded = json.loads(self._text)
        assert self._loaded is not None
        return self._loaded

    def __getitem__(self, name: str) -> Any:
        return self._figures()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._figures())

    def __len__(self) -> int:
        return len(self._figures())


class Tuning(Figures):
    """What Dump.tune() gives: the figures of ``psf tune --json``.

    ``rows``: a flat dict for each set, least error first; pandas.DataFrame() takes it.
    ``best``: the choice, for ``dump.filter(**tuning.best)``.
    """

    def __init__(self, text: str, rows: list[dict[str, Any]], best: dict[str, str]) -> None:
        super().__init__(text)
        self.rows = [with_underscores(row) for row in rows]
        self.best: dict[str, Any] = with_underscores(best)

    def save(self, path: str) -> None:
        """Writes the bytes of ``psf tune --json``; ``psf filter --tuned`` takes them."""
        _write(path, self._text)

    def __repr__(self) -> str:
        return f"<psf.Tuning of {len(self.rows)} sets, {'sure' if self['sure'] else 'not sure'}>"


class Convergence(Figures):
    """What converge() gives: the figures of converge.json.

    ``rows``: a flat dict for each set and each n, with the columns of converge.csv, "unfiltered"
    first; pandas.DataFrame() takes it.
    """

    def __init__(self, text: str, csv: str, rows: list[dict[str, Any]]) -> None:
        super().__init__(text)
        self._csv = csv
        self.rows = [with_underscores(row) for row in rows]

    def save(self, folder: str) -> None:
        """Writes converge.json and converge.csv as ``psf converge -o`` does; ``psf report`` takes
        the folder."""
        os.makedirs(folder, exist_ok=True)
        _write(os.path.join(folder, "converge.json"), self._text)
        _write(os.path.join(folder, "converge.csv"), self._csv)

    def __repr__(self) -> str:
        return f"<psf.Convergence of {len(self['series']) - 1} sets, n up to {self['n'][-1]}>"


class Explanation(Figures):
    """What Dump.explain() gives: the figures of ``psf explain --json``; ``print()`` shows what the
    command prints."""

    def __init__(self, explanation: _psf.Explanation) -> None:
        super().__init__("")
        self._explanation = explanation

    def _figures(self) -> dict[str, Any]:
        self._text = self._text or self._explanation.json()
        return super()._figures()

    def text(self, rows: int | None = 5) -> str:
        """The text with so many rows a table; None: ``psf explain --all``."""
        return self._explanation.whole_text() if rows is None else self._explanation.text(rows)

    def save(self, path: str) -> None:
        """Writes .json, the bytes of ``psf explain --json``, or .ply, those of ``--ply``."""
        self._explanation.save(path)

    def __str__(self) -> str:
        return self.text()

    def __repr__(self) -> str:
        return f"<psf.Explanation: {self.text().splitlines()[0]}>"


def _write(path: str, text: str) -> None:
    with open(path, "w", encoding="utf-8", newline="\n") as file:
        file.write(text)


def warn(notes: Iterable[str], stacklevel: int = 3) -> None:
    for note in notes:
        warnings.warn(note.replace("`", ""), stacklevel=stacklevel)


def camera_number(dump: Dump, camera: str | None) -> int:
    """The place of a camera; None: the first."""
    if camera is None:
        return 0
    names = [one.name for one in dump.cameras]
    if camera not in names:
        raise KeyError(f"{dump.path}: has no camera {camera}; it has {', '.join(names)}")
    return names.index(camera)


def _render_text(render: Mapping[str, Any] | str) -> str:
    if isinstance(render, str):
        with open(render, encoding="utf-8") as file:
            return file.read()
    return json.dumps(dict(render))


def converge(dumps: Sequence[Union[Dump, str]], reference: Picture | str, *,
             passes: int | None = None, camera: str | None = None, epsilon: float = 0.01,
             all_metrics: bool = False, times: bool = True,
             renders: Sequence[Mapping[str, Any] | str] = (), max_memory: int | None = None,
             no_weights: bool = False, progress: Progress = None,
             **parameters: Value | Iterable[Value]) -> Convergence:
    """What ``psf converge`` does: errors after 1, 2, 4, ... passes of every combination of the
    parameters' values.

    ``dumps`` are of one scene and with different seeds: from two on bias and variance are told
    apart, from three on they have 95% intervals. ``passes``: the first so many; ``all_metrics``:
    SSIM and FLIP too; ``times``: run each set once more to take its time; ``renders``: the figures
    of the renders, ``dump.rendered`` or files that ``psf-render --json`` wrote, for speed-ups.
    """
    from psf._dump import Dump, open

    opened = [one if isinstance(one, Dump) else open(one) for one in dumps[:1]]
    paths = [one.path if isinstance(one, Dump) else one for one in dumps]
    if isinstance(reference, str):
        reference = read_picture(reference)
    number = camera_number(opened[0], camera) if opened else 0
    with shown(progress, "converge") as report:
        text, csv, rows, notes = _psf.converge(
            paths, reference._picture, lists(parameters), no_weights, passes, number, epsilon,
            all_metrics, times, [_render_text(one) for one in renders], max_memory, report)
    warn(notes)
    return Convergence(text, csv, rows)
