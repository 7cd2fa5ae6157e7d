"""What studies give: the figures of the commands' JSON, rows for tables, and files."""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from psf import _psf
from psf._picture import Picture, as_picture
from psf._progress import Progress, shown
from psf._values import (FileName, Value, file_name, items, lists, psf_error, real,
                         vertex_text, whole_or_none, with_underscores)

if TYPE_CHECKING:
    from psf._dump import Dump
    from psf._frames import Sequence


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

    def __init__(self, result: _psf.TuneResult) -> None:
        super().__init__(result.json)
        self._result = result
        self.rows = [with_underscores(row) for row in result.rows]
        self.best: dict[str, Any] = with_underscores(result.best)
        if "vertex" in self["input"]:
            self.best["vertex"] = self["input"]["vertex"]

    def save(self, path: FileName) -> None:
        """Writes the bytes of ``psf tune --json``; ``psf filter --tuned`` takes them."""
        self._result.save(file_name("path", path))

    def __repr__(self) -> str:
        return f"<psf.Tuning of {len(self.rows)} sets, {'sure' if self['sure'] else 'not sure'}>"


class Ablation(Figures):
    """What Dump.ablate() gives: the figures of ``psf ablate --json``. It shows itself in a notebook
    as the sheet of all pictures with their labels.

    ``rows``: a flat dict for each picture; pandas.DataFrame() takes it. ``pictures``: in the order
    of the rows.
    """

    def __init__(self, result: _psf.AblationResult) -> None:
        super().__init__(result.json)
        self._result = result
        self.rows = [with_underscores(row) for row in result.rows]
        self.pictures = [Picture(picture) for picture in result.take_pictures()]

    def save(self, path: FileName) -> None:
        """Writes the sheet, the bytes of ``psf ablate -o sheet.png``."""
        self._result.save(file_name("path", path))

    def _repr_png_(self) -> bytes:
        return self._result.png

    def __repr__(self) -> str:
        return f"<psf.Ablation of {len(self.rows)} pictures>"


class Convergence(Figures):
    """What converge() gives: the figures of converge.json.

    ``rows``: a flat dict for each set and each n, with the columns of converge.csv, "unfiltered"
    first; pandas.DataFrame() takes it.
    """

    def __init__(self, result: _psf.ConvergeResult) -> None:
        super().__init__(result.json)
        self._result = result
        self.rows = [with_underscores(row) for row in result.rows]

    def save(self, folder: FileName) -> None:
        """Writes converge.json and converge.csv as ``psf converge -o`` does; ``psf report`` takes
        the folder. A study that is there already stays."""
        self._result.save(file_name("folder", folder))

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

    def save(self, path: FileName) -> None:
        """Writes .json, the bytes of ``psf explain --json``, or .ply, those of ``--ply``."""
        self._explanation.save(file_name("path", path))

    def __str__(self) -> str:
        return self.text()

    def __repr__(self) -> str:
        return f"<psf.Explanation: {self.text().splitlines()[0]}>"


def warn(notes: Iterable[str], stacklevel: int = 3) -> None:
    for note in notes:
        warnings.warn(note.replace("`", ""), stacklevel=stacklevel)


def camera_number(dump: Dump | Sequence, camera: str | None) -> int:
    """The place of a camera; None: the first."""
    if camera is None:
        return 0
    names = [one.name for one in dump.cameras]
    if camera not in names:
        raise KeyError(f"{dump.path}: has no camera {camera}; it has {', '.join(names)}")
    return names.index(camera)


def _render_text(render: Mapping[str, Any] | FileName | None) -> str:
    """The figures of a render as text, if they are."""
    if render is None:
        raise TypeError("renders: None, which is rendered of a dump that was not rendered here; "
                        "give the file that psf-render --json wrote")
    name = "renders"
    if not isinstance(render, Mapping):
        name = file_name("renders", render)
        try:
            with open(name, encoding="utf-8") as file:
                render = json.load(file)
        except OSError as error:
            raise psf_error(4, f"{name}: cannot be read: {error.strerror}") from None
        except ValueError:
            render = None
    for key in ("passes", "seconds", "output_seconds"):
        value = render.get(key) if isinstance(render, Mapping) else None
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise psf_error(3, f"{name}: has no number '{key}'; give what psf-render --json wrote")
    assert isinstance(render, Mapping)
    return json.dumps(dict(render))


def converge(dumps: Dump | FileName | Iterable[Dump | FileName], reference: Picture | FileName, *,
             passes: int | None = None, camera: str | None = None, epsilon: float = 0.01,
             all_metrics: bool = False, times: bool = True,
             renders: Mapping[str, Any] | FileName | Iterable[Mapping[str, Any] | FileName] = (),
             max_memory: int | None = None, vertex: str | None = None, no_weights: bool = False,
             progress: Progress = None, **parameters: Value | Iterable[Value]) -> Convergence:
    """What ``psf converge`` does: errors after 1, 2, 4, ... passes of every combination of the
    parameters' values.

    ``dumps`` are of one scene and with different seeds: from two on bias and variance are told
    apart, from three on they have 95% intervals. ``passes``: the first so many; ``all_metrics``:
    SSIM and FLIP too; ``times``: run each set once more to take its time; ``renders``: the figures
    of the renders, ``dump.rendered`` or files that ``psf-render --json`` wrote, for speed-ups.
    """
    from psf._dump import Dump, open

    given = items(dumps)
    opened = [one if isinstance(one, Dump) else open(one) for one in given[:1]]
    paths = [one.path if isinstance(one, Dump) else file_name("dumps", one) for one in given]
    picture = as_picture("reference", reference)._picture
    number = camera_number(opened[0], camera) if opened else 0
    with shown(progress, "converge") as report:
        result = _psf.converge(
            paths, picture, lists(parameters), no_weights, whole_or_none("passes", passes), number,
            real("epsilon", epsilon), all_metrics, times,
            [_render_text(one) for one in items(renders)],
            whole_or_none("max_memory", max_memory), vertex_text(vertex), report)
    warn(result.notes)
    return Convergence(result)
