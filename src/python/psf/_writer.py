"""Dumps: writing."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from psf import _psf
from psf._psf import Camera
from psf._values import FileName, as_column, file_name


class DumpWriter:
    """Writes a dump, pass by pass; as a context manager it closes the file, unless it raises."""

    def __init__(self, path: FileName, cameras: Sequence[Camera],
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
        self._writer: _psf.DumpWriter | None = _psf.DumpWriter(
            file_name("path", path), list(cameras), kinds, compress,
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
            array = as_column(name, columns[name], dtype.str, components, count)
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


def create(path: FileName, cameras: Sequence[Camera],
           channels: Mapping[str, str | tuple[str, int]],
           metadata: Mapping[str, Any] | None = None, compress: bool = True) -> DumpWriter:
    """Begins a dump: ``channels`` are types by name, {"position": ("f4", 3), "pixel": "u4"}.

        with psf.create("out.pvb", cameras, channels) as writer:
            writer.append(position=x, pixel=p)
            writer.commit_pass()
    """
    return DumpWriter(path, cameras, channels, metadata, compress)
