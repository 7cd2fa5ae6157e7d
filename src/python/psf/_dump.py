"""Dumps: reading, filtering, sweeps."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

import numpy.typing as npt

from psf import _psf
from psf._picture import Picture, as_picture
from psf._progress import Progress, shown
from psf._psf import Camera, Channel
from psf._studies import Ablation, Explanation, Tuning, camera_number, warn
from psf._values import (FileName, Passes, Value, file_name, items, lists, pass_range, real, text,
                         texts, vertex_text, whole, whole_or_none, with_underscores, wrong)


class _Column:
    """A channel of a dump, read where it is indexed."""

    def __init__(self, dump: _psf.Dump, channel: Channel) -> None:
        self._dump, self._channel = dump, channel

    def __len__(self) -> int:
        return self._dump.records

    def __getitem__(self, index: int | slice) -> npt.NDArray[Any]:
        if isinstance(index, slice):
            first, last, step = index.indices(len(self))
            if step <= 0:
                raise ValueError(f"{self._channel.name}: a slice goes forward")
            return self._dump.read(self._channel, first, max(0, last - first))[::step]
        number = range(len(self))[index]
        value: npt.NDArray[Any] = self._dump.read(self._channel, number, 1)[0]
        return value

    def __array__(self, dtype: npt.DTypeLike = None, copy: bool | None = None) -> npt.NDArray[Any]:
        values = self[:]
        return values if dtype is None else values.astype(dtype)

    def __repr__(self) -> str:
        shape = f" x {self._channel.components}" if self._channel.components > 1 else ""
        return f"<channel {self._channel.name}, {len(self)} of {self._channel.type}{shape}>"


class Dump:
    """A path-vertex buffer. ``dump["position"][a:b]`` reads these records and no others.

    ``rendered``: the figures of psf.render(), where that made the dump.
    """

    def __init__(self, path: FileName) -> None:
        self._dump = _psf.Dump(file_name("path", path))
        self.rendered: dict[str, Any] | None = None

    @property
    def path(self) -> str:
        return self._dump.path

    @property
    def records(self) -> int:
        return self._dump.records

    @property
    def passes(self) -> int:
        return self._dump.passes

    @property
    def closed(self) -> bool:
        """Whether its producer has finished it."""
        return self._dump.closed

    @property
    def metadata(self) -> dict[str, Any]:
        loaded: dict[str, Any] = json.loads(self._dump.metadata)
        return loaded

    @property
    def channels(self) -> list[Channel]:
        return self._dump.channels

    @property
    def cameras(self) -> list[Camera]:
        return self._dump.cameras

    def refresh(self) -> bool:
        """Takes in what was committed since; whether there was anything."""
        return self._dump.refresh()

    def __getitem__(self, channel: str) -> _Column:
        for one in self.channels:
            if one.name == channel:
                return _Column(self._dump, one)
        names = ", ".join(one.name for one in self.channels)
        raise KeyError(f"{self.path}: has no channel {channel}; it has {names}")

    def filter_all(self, *, passes: Passes = None, max_memory: int | None = None,
                   vertex: str | None = None, no_weights: bool = False, progress: Progress = None,
                   **parameters: Value) -> list[Picture]:
        """What ``psf filter`` does: a picture of every camera. Of a dump of several frames
        ``psf.open_sequence()`` filters them all.

        ``vertex``, here and of the studies: average at another vertex of the paths, "first-rough",
        "depth:1", "roughness:0.5" or "distance:20", where the dump has all.
        """
        with shown(progress, "filter") as report:
            result = self._dump.filter(texts(parameters), no_weights,
                                       pass_range(passes, self.passes),
                                       whole_or_none("max_memory", max_memory),
                                       vertex_text(vertex), report)
        warn(result.notes)
        return [Picture(picture) for picture in result.take_pictures()]

    def filter(self, camera: str | None = None, *, passes: Passes = None,
               max_memory: int | None = None, vertex: str | None = None, no_weights: bool = False,
               progress: Progress = None, **parameters: Value) -> Picture:
        """What ``psf filter`` does: the picture of a camera, the first unless named."""
        number = camera_number(self, camera)
        pictures = self.filter_all(passes=passes, max_memory=max_memory, vertex=vertex,
                                   no_weights=no_weights, progress=progress, **parameters)
        return pictures[number]

    def sweep(self, reference: Picture | FileName, *, metrics: str | Iterable[str] = "relMSE",
              camera: str | None = None, passes: Passes = None, max_memory: int | None = None,
              vertex: str | None = None, no_weights: bool = False, progress: Progress = None,
              **parameters: Value | Iterable[Value]) -> list[dict[str, Any]]:
        """What ``psf sweep`` does: a row for each combination of the parameters' values.

        A row has the text of every parameter and the value of every metric, ``neighbors`` and
        ``seconds``; pandas.DataFrame(rows) takes it. Sets that differ in r0 and delta alone share
        the work. A list may be text, as of the command: r0="2px:32px:x2".
        """
        picture = as_picture("reference", reference)._picture
        names = [text("metrics", one) for one in items(metrics)]
        with shown(progress, "sweep") as report:
            rows, notes = self._dump.sweep(picture, lists(parameters), no_weights, names,
                                           pass_range(passes, self.passes),
                                           whole_or_none("max_memory", max_memory),
                                           camera_number(self, camera), vertex_text(vertex),
                                           report)
        warn(notes)
        return [with_underscores(row) for row in rows]

    def tune(self, *, camera: str | None = None, passes: Passes = None, epsilon: float = 0.01,
             max_memory: int | None = None, vertex: str | None = None, no_weights: bool = False,
             progress: Progress = None, **parameters: Value | Iterable[Value]) -> Tuning:
        """What ``psf tune`` does: the error of every combination of the parameters' values, without
        a reference, from independent parts of the passes.

            tuning = dump.tune(delta=[0.2, 1/3])       # nine radii from 2px to 32px unless given
            picture = dump.filter(**tuning.best)
        """
        with shown(progress, "tune") as report:
            result = self._dump.tune(
                lists(parameters), no_weights, pass_range(passes, self.passes),
                camera_number(self, camera), real("epsilon", epsilon),
                whole_or_none("max_memory", max_memory), vertex_text(vertex), report)
        warn(result.notes)
        return Tuning(result)

    def ablate(self, reference: Picture | FileName | None = None, *, metric: str = "relMSE",
               epsilon: float = 0.01, exposure: float = 0,
               crop: tuple[int, int, int, int] | None = None, columns: int = 5,
               camera: str | None = None, passes: Passes = None, max_memory: int | None = None,
               vertex: str | None = None, no_weights: bool = False, progress: Progress = None,
               **parameters: Value) -> Ablation:
        """What ``psf ablate`` does: the weights one after another, blocks against each other, and
        iterations of one pass.

        ``metric``: the error on the sheet; ``exposure``: stops; ``crop``: the part of the pictures
        that the sheet shows, (x, y, width, height), with ``columns`` beside each other.
        """
        picture = None if reference is None else as_picture("reference", reference)._picture
        place = [whole("crop", one, 1 << 32) for one in items(crop or (0, 0, 0, 0))]
        if len(place) != 4:
            raise wrong("crop", "(x, y, width, height)", crop)
        with shown(progress, "ablate") as report:
            result = self._dump.ablate(
                texts(parameters), no_weights, pass_range(passes, self.passes),
                camera_number(self, camera), picture, text("metric", metric),
                real("epsilon", epsilon), real("exposure", exposure),
                (place[0], place[1], place[2], place[3]), whole("columns", columns, 1 << 32),
                whole_or_none("max_memory", max_memory), vertex_text(vertex), report)
        warn(result.notes)
        return Ablation(result)

    def explain(self, pixel: tuple[int, int] | None = None, *, path: int | None = None,
                camera: str | None = None, passes: Passes = None, vertex: str | None = None,
                no_weights: bool = False, progress: Progress = None,
                **parameters: Value) -> Explanation:
        """What ``psf explain`` does: why a pixel of the filtered picture is what it is.

        ``pixel``: (x, y), (0, 0) at the top left; or one ``path``, by its number in the dump.
        ``print()`` of what is returned shows the command's text, and ["sources"] of it are figures.
        """
        if (pixel is None) == (path is None):
            raise TypeError("explain: give a pixel (x, y) or a path")
        place = None
        if pixel is not None:
            pair = [whole("pixel", one, 1 << 32) for one in items(pixel)]
            if len(pair) != 2:
                raise wrong("pixel", "(x, y)", pixel)
            place = pair[0], pair[1]
        number = whole("path", path or 0)
        with shown(progress, "explain") as report:
            explained = self._dump.explain(place, number, texts(parameters), no_weights,
                                           pass_range(passes, self.passes),
                                           camera_number(self, camera), vertex_text(vertex),
                                           report)
        warn(explained.notes())
        return Explanation(explained)

    def __repr__(self) -> str:
        return f"<psf.Dump {self.path}: {self.passes} passes, {self.records} records>"


def open(path: FileName) -> Dump:
    """Opens a path-vertex buffer."""
    return Dump(path)
