"""Dumps: reading, filtering, sweeps."""

from __future__ import annotations

import itertools
import json
import warnings
from collections.abc import Iterable, Sequence
from typing import Any

import numpy.typing as npt

from psf import _psf
from psf._picture import Picture, read_picture
from psf._psf import Camera, Channel
from psf._values import Passes, Progress, Value, as_list, pass_range, texts


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
    """A path-vertex buffer. ``dump["position"][a:b]`` reads these records and no others."""

    def __init__(self, path: str) -> None:
        self._dump = _psf.Dump(path)

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
                   no_weights: bool = False, progress: Progress | None = None,
                   **parameters: Value) -> list[Picture]:
        """What ``psf filter`` does: a picture of every camera."""
        first, last = pass_range(passes, self.passes)
        result = self._dump.filter(texts(parameters), no_weights, first, last, max_memory, progress)
        for note in result.notes:
            warnings.warn(note.replace("`", ""), stacklevel=3)
        return [Picture(picture) for picture in result.take_pictures()]

    def filter(self, camera: str | None = None, *, passes: Passes = None,
               max_memory: int | None = None, no_weights: bool = False,
               progress: Progress | None = None, **parameters: Value) -> Picture:
        """What ``psf filter`` does: the picture of a camera, the first unless named."""
        if camera is not None and camera not in [one.name for one in self.cameras]:
            raise KeyError(f"{self.path}: has no camera {camera}")
        pictures = self.filter_all(passes=passes, max_memory=max_memory, no_weights=no_weights,
                                   progress=progress, **parameters)
        return next(one for one in pictures if camera in (None, one.camera))

    def sweep(self, reference: Picture | str, *, metrics: str | Sequence[str] = "relMSE",
              camera: str | None = None, passes: Passes = None, max_memory: int | None = None,
              no_weights: bool = False, progress: Progress | None = None,
              **lists: Value | Iterable[Value]) -> list[dict[str, Any]]:
        """What ``psf sweep`` does: a row for each combination of the parameters' values.

        A row has the text of every parameter and the value of every metric, ``neighbors`` and
        ``seconds``; pandas.DataFrame(rows) takes it. Sets that differ in r0 and delta alone share
        the work.
        """
        if isinstance(reference, str):
            reference = read_picture(reference)
        values = [as_list(value) for value in lists.values()]
        sets = [texts(dict(zip(lists, combination))) for combination in itertools.product(*values)]
        first, last = pass_range(passes, self.passes)
        names = [metrics] if isinstance(metrics, str) else list(metrics)
        number = [one.name for one in self.cameras].index(camera) if camera is not None else 0
        rows = self._dump.sweep(reference._picture, sets, no_weights, names, first, last, max_memory,
                                number, progress)
        return [{name.replace("-", "_"): value for name, value in row.items()} for row in rows]

    def __repr__(self) -> str:
        return f"<psf.Dump {self.path}: {self.passes} passes, {self.records} records>"


def open(path: str) -> Dump:
    """Opens a path-vertex buffer."""
    return Dump(path)
