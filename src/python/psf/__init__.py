"""Path space filtering of path-vertex buffers: numpy arrays in, numpy arrays out.

    import psf
    dump = psf.open("cornell.pvb")
    picture = dump.filter(r0="8px", delta=1/3, block="4passes", normal=0.95)
    picture.rgb                                    # (height, width, 3) float32, linear
    picture.error("reference.exr", "relMSE")
    picture.save("out.exr")

The parameters are those of ``psf filter``, by the same names with underscores: numbers, text
("8px", "1/4"), True and False, and None for a weight that is off. ``psf.parameters()`` lists them.
Mistakes and files that cannot be read raise ``psf.Error``, whose message is one line and whose
``code`` is the exit code of the command. Long calls release the interpreter lock, end on ^C, and
take ``progress``, a function of what is done and of all there is.
"""

from __future__ import annotations

import itertools
import json
import struct
import warnings
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import TracebackType
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from psf import _psf
from psf._psf import Camera, Channel, Error

__version__: str = _psf.version
__all__ = [
    "Camera", "Channel", "Dump", "DumpWriter", "Error", "FilteredRecords", "Parameter", "Picture",
    "create", "filter_records", "geomspace", "metrics", "open", "parameters", "read_picture",
]

Value = Union[str, float, bool, None]  # of a parameter
Progress = Callable[[int, int], None]
Passes = Union[int, slice, None]  # the first n, or a slice first:last; None: all


class Parameter:
    """A parameter of the filter: its name, what its text looks like, what it does, its default."""

    def __init__(self, name: str, type: str, help: str, default: str) -> None:
        self.name, self.type, self.help, self.default = name, type, help, default

    def __repr__(self) -> str:
        return f"{self.name}={self.default!r}: {self.help}"


def parameters() -> list[Parameter]:
    """Every parameter of the filter."""
    return [Parameter(name.replace("-", "_"), *rest) for name, *rest in _psf.parameters()]


def metrics() -> list[str]:
    """The names of the metrics that compare a picture with a reference."""
    return _psf.metric_names()


def geomspace(first: float, last: float, count: int, unit: str = "px") -> list[str]:
    """``count`` radii from ``first`` to ``last``, each the same factor above the one before."""
    return [f"{value:.5g}{unit}" for value in np.geomspace(first, last, count)]


def _text(value: Value) -> str:
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or value is False:
        return "off"
    if value is True:
        return "on"
    return value if isinstance(value, str) else f"{value:.17g}"


def _texts(given: Mapping[str, Value]) -> dict[str, str]:
    return {name.replace("_", "-"): _text(value) for name, value in given.items()}


def _list(value: Value | Iterable[Value]) -> list[Value]:
    if value is None or isinstance(value, (str, float, int, np.generic)):
        return [value]
    return list(value)


def _range(passes: Passes, all: int) -> tuple[int, int | None]:
    if isinstance(passes, slice):
        first, last, step = passes.indices(all)
        if step != 1:
            raise ValueError("passes: a slice first:last, without a step")
        # Beyond the end is an error of the library, not a shorter slice.
        beyond = passes.stop is not None and passes.stop > all
        return first, passes.stop if beyond else last
    if passes is not None and passes < 0:
        raise ValueError(f"passes: {passes} is no number of passes")
    return 0, passes


def _column(name: str, values: npt.ArrayLike | None, dtype: str, components: int,
            count: int | None) -> npt.NDArray[Any] | None:
    """An array of the type and shape of a channel; what fits is not copied."""
    if values is None:
        return None
    given = np.asarray(values)
    wanted = np.dtype(dtype)
    if given.dtype.kind not in "biuf":
        raise TypeError(f"{name}: {given.dtype} is no type of numbers")
    array = np.ascontiguousarray(given, dtype=wanted)
    rows = len(array) if count is None else count
    expected = (rows,) if components == 1 else (rows, components)
    if array.shape != expected:
        raise ValueError(f"{name}: shape {given.shape}, expected {expected}")
    if wanted.kind == "u" and given.dtype != wanted and not np.array_equal(array, given):
        raise ValueError(f"{name}: a value does not fit into {wanted}")
    return array


class Picture:
    """A picture of one camera with its layers."""

    def __init__(self, picture: _psf.Picture) -> None:
        self._picture = picture

    @property
    def width(self) -> int:
        return self._picture.width

    @property
    def height(self) -> int:
        return self._picture.height

    @property
    def camera(self) -> str:
        """The name of the camera."""
        return self._picture.camera

    @property
    def attributes(self) -> dict[str, str]:
        """What its EXR says of it: the dump, and every parameter."""
        return self._picture.attributes

    @property
    def layers(self) -> list[str]:
        """The names of its layers, for ``picture[name]``."""
        return self._picture.layer_names

    def __getitem__(self, layer: str) -> npt.NDArray[np.float32]:
        """A layer, (height, width); a view, which is not copied."""
        return self._picture.layer(layer)

    @property
    def rgb(self) -> npt.NDArray[np.float32]:
        """The colours, (height, width, 3), linear."""
        return self._picture.rgb()

    @property
    def unfiltered(self) -> npt.NDArray[np.float32]:
        """The colours of the same paths without filter, (height, width, 3)."""
        return self._picture.rgb("unfiltered-input.")

    @property
    def neighbors(self) -> npt.NDArray[np.float32]:
        """The mean number of records averaged, (height, width)."""
        return self["neighbors.Y"]

    @property
    def radius(self) -> npt.NDArray[np.float32]:
        """The mean radius in world units, (height, width)."""
        return self["radius.Y"]

    def error(self, reference: Picture | str, metric: str = "relMSE") -> float:
        """The error against a reference, a picture or an EXR file, by a metric of ``metrics()``."""
        if isinstance(reference, str):
            reference = read_picture(reference)
        return self._picture.error(reference._picture, metric)

    def save(self, path: str) -> None:
        """Writes an EXR with all layers, or a PNG to look at: the bytes of ``psf filter -o``."""
        self._picture.save(path)

    def png(self, exposure: float = 0) -> bytes:
        """The bytes of a PNG to look at: times 2^exposure, tone-mapped."""
        rows = self._picture.displayed(exposure)
        lines = b"".join(b"\0" + row.tobytes() for row in rows)

        def chunk(kind: bytes, data: bytes) -> bytes:
            checksum = zlib.crc32(kind + data)
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", checksum)

        header = struct.pack(">IIBBBBB", self.width, self.height, 8, 2, 0, 0, 0)
        return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
                chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b""))

    def _repr_png_(self) -> bytes:
        return self.png()

    def __repr__(self) -> str:
        name = f" of {self.camera}" if self.camera else ""
        return f"<psf.Picture{name}, {self.width} x {self.height}: {', '.join(self.layers)}>"


def read_picture(path: str, layer: str = "") -> Picture:
    """Reads the colours of an EXR: its root or the layer of this name."""
    return Picture(_psf.Picture.read(path, layer))


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
        first, last = _range(passes, self.passes)
        result = self._dump.filter(_texts(parameters), no_weights, first, last, max_memory, progress)
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
        values = [_list(value) for value in lists.values()]
        sets = [_texts(dict(zip(lists, combination))) for combination in itertools.product(*values)]
        first, last = _range(passes, self.passes)
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


class FilteredRecords:
    """What filter_records() gives: arrays by record, and the pictures."""

    def __init__(self, c_bar: npt.NDArray[np.float32], neighbors: npt.NDArray[np.uint32],
                 radius: npt.NDArray[np.float32], pictures: list[Picture]) -> None:
        self.c_bar, self.neighbors, self.radius = c_bar, neighbors, radius
        self.pictures = pictures


def filter_records(*, cameras: Sequence[Camera], position: npt.ArrayLike,
                   throughput: npt.ArrayLike, contribution: npt.ArrayLike, pixel: npt.ArrayLike,
                   distance: npt.ArrayLike | None = None, unfiltered: npt.ArrayLike | None = None,
                   normal: npt.ArrayLike | None = None, reflectance: npt.ArrayLike | None = None,
                   direction: npt.ArrayLike | None = None,
                   hit_distance: npt.ArrayLike | None = None,
                   roughness: npt.ArrayLike | None = None,
                   visibility: npt.ArrayLike | None = None, material: npt.ArrayLike | None = None,
                   camera: npt.ArrayLike | None = None, flags: npt.ArrayLike | None = None,
                   parameters: Mapping[str, Value] = {}, no_weights: bool = False,
                   n: float = 0) -> FilteredRecords:
    """Filters records that are in memory, one block of a record a path, in path order.

    What each array is, and its unit, is in the format's table of channels. ``parameters``: as for
    Dump.filter(), {"r0": "8px", "normal": 0.9}; apart, because weights and channels share names.
    ``n``: samples per pixel accumulated up to the end of the block, for radii that shrink; 0: those
    of the records.
    """
    count = len(np.asarray(pixel))

    def column(name: str, values: npt.ArrayLike | None, dtype: str, components: int = 1) -> Any:
        return _column(name, values, dtype, components, count)

    c_bar, neighbors, radius, pictures = _psf.filter_records(
        list(cameras), _texts(parameters), no_weights, n,
        column("position", position, "f4", 3), column("throughput", throughput, "f4", 3),
        column("contribution", contribution, "f4", 3), column("pixel", pixel, "u4"),
        column("distance", distance, "f4"), column("unfiltered", unfiltered, "f4", 3),
        column("normal", normal, "f4", 3), column("reflectance", reflectance, "f4", 3),
        column("direction", direction, "f4", 3), column("hit_distance", hit_distance, "f4"),
        column("roughness", roughness, "f4"), column("visibility", visibility, "u4"),
        column("material", material, "u4"), column("camera", camera, "u2"),
        column("flags", flags, "u1"))
    return FilteredRecords(c_bar, neighbors, radius, [Picture(picture) for picture in pictures])


class DumpWriter:
    """Writes a dump, pass by pass; as a context manager it closes the file, unless it raises."""

    def __init__(self, path: str, cameras: Sequence[Camera],
                 channels: Mapping[str, str | tuple[str, int]],
                 metadata: Mapping[str, Any] | None = None, compress: bool = True) -> None:
        self._rows: list[tuple[str, np.dtype[Any], int]] = []
        for name, kind in channels.items():
            name_of_type, components = kind if isinstance(kind, tuple) else (kind, 1)
            # The format is little-endian.
            self._rows.append((name, np.dtype(name_of_type).newbyteorder("<"), components))
        kinds = [(name, f"{dtype.kind}{8 * dtype.itemsize}", components, False)
                 for name, dtype, components in self._rows]
        self._closed = False
        self._writer: _psf.DumpWriter | None = _psf.DumpWriter(path, list(cameras), kinds, compress,
                                       json.dumps(dict(metadata)) if metadata else "")

    def append(self, **columns: npt.ArrayLike) -> None:
        """Appends records to the current pass: an array for each channel, of as many rows."""
        missing = [name for name, _, _ in self._rows if name not in columns]
        unknown = [name for name in columns if name not in [row[0] for row in self._rows]]
        if missing or unknown:
            raise ValueError(f"append: missing {missing}, unknown {unknown}")
        arrays: list[npt.NDArray[Any]] = []
        for name, dtype, components in self._rows:
            count = len(arrays[0]) if arrays else None
            array = _column(name, columns[name], dtype.str, components, count)
            assert array is not None
            arrays.append(array)
        self._open().append(len(arrays[0]), arrays)

    def _open(self) -> _psf.DumpWriter:
        if self._writer is None:
            raise ValueError("the dump was given up after an error")
        return self._writer

    def commit_pass(self) -> None:
        """Ends a pass: what was appended is in the file."""
        self._open().commit_pass()

    def close(self) -> None:
        """Says that there is nothing to come."""
        self._open().close()
        self._closed = True

    @property
    def records(self) -> int:
        """How many are committed."""
        return self._open().records

    @property
    def passes(self) -> int:
        """How many are committed."""
        return self._open().passes

    def __enter__(self) -> DumpWriter:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None,
                 trace: TracebackType | None) -> None:
        if kind is not None:
            self._writer = None  # the file is no longer being written
        elif not self._closed:
            self.close()


def create(path: str, cameras: Sequence[Camera],
           channels: Mapping[str, str | tuple[str, int]],
           metadata: Mapping[str, Any] | None = None, compress: bool = True) -> DumpWriter:
    """Begins a dump: ``channels`` are types by name, {"position": ("f4", 3), "pixel": "u4"}.

        with psf.create("out.pvb", cameras, channels) as writer:
            writer.append(position=x, pixel=p)
            writer.commit_pass()
    """
    return DumpWriter(path, cameras, channels, metadata, compress)
