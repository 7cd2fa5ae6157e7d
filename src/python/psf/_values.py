"""Values of parameters, passes and columns as the library takes them."""

from __future__ import annotations

import numbers
import operator
import os
import reprlib
from collections.abc import Iterable, Mapping
from decimal import Decimal
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from psf._psf import Error

Value = Union[str, float, bool, None]  # of a parameter
Passes = Union[int, slice, None]  # the first n, or a slice first:last; None: all
FileName = Union[str, "os.PathLike[str]"]
FRAMES = 1 << 32  # a frame's number is below


def wrong(name: str, expected: str, value: object) -> TypeError:
    """The error of an argument of another type, one line."""
    return TypeError(f"{name}: expected {expected}, not {' '.join(reprlib.repr(value).split())}")


def psf_error(code: int, message: str) -> Error:
    error = Error(message)
    error.code = code
    return error


def file_name(name: str, value: Any) -> str:
    try:
        return os.fsdecode(value)
    except TypeError:
        raise wrong(name, "a file name", value) from None


def items(value: Any) -> list[Any]:
    """What a list, a generator or an array holds; anything else, a text too, is one item."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    one = isinstance(value, (str, bytes, Mapping)) or not isinstance(value, Iterable)
    return [value] if one else list(value)


def whole(name: str, value: Any, end: int = 1 << 64) -> int:
    """A whole number from 0 to below ``end``."""
    try:
        number = operator.index(value)
    except TypeError:
        raise wrong(name, "a whole number", value) from None
    if not 0 <= number < end:
        raise ValueError(f"{name}: {number} is no whole number from 0 to {end - 1}")
    return number


def whole_or_none(name: str, value: Any) -> int | None:
    return None if value is None else whole(name, value)


def real(name: str, value: Any) -> float:
    if isinstance(value, (numbers.Real, Decimal)):
        return float(value)
    raise wrong(name, "a number", value)


def text(name: str, value: Any) -> str:
    if isinstance(value, (np.generic, np.ndarray)) and value.size == 1:
        value = value.item()
    if value is None or value is False:
        return "off"
    if value is True:
        return "on"
    if isinstance(value, str):
        return value
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, (numbers.Real, Decimal)):
        return f"{float(value):.17g}"
    raise wrong(name, "a number, text, True, False or None", value)


def vertex_text(value: Any) -> str:
    """A rule for the vertex as the commands take it; None: the vertex of the file, an empty text."""
    if value is None or (isinstance(value, str) and value):
        return value or ""
    raise wrong("vertex", "a text such as 'depth:1', or None", value)


def texts(given: Mapping[str, Value]) -> dict[str, str]:
    return {name.replace("_", "-"): text(name, value) for name, value in given.items()}


def lists(given: Mapping[str, Value | Iterable[Value]]) -> dict[str, str]:
    """Lists of values as the commands take them: "2px,4px". A text may be a list or a range."""
    return {name.replace("_", "-"): ",".join(text(name, one) for one in _as_list(name, value))
            for name, value in given.items()}


def _as_list(name: str, value: Value | Iterable[Value]) -> list[Any]:
    values = items(value)
    if not values:
        raise ValueError(f"{name}: an empty list")
    return values


def with_underscores(row: Mapping[str, Any]) -> dict[str, Any]:
    """Names of parameters as those of keywords."""
    return {name.replace("-", "_"): value for name, value in row.items()}


def pass_range(passes: Passes, all: int) -> tuple[int, int | None]:
    if isinstance(passes, slice):
        try:
            first, last, step = passes.indices(all)
        except TypeError:
            raise wrong("passes", "a slice of whole numbers", passes) from None
        if step != 1:
            raise ValueError("passes: a slice first:last, without a step")
        # Beyond the end is an error of the library, not a shorter slice.
        beyond = passes.stop is not None and passes.stop > all
        return first, passes.stop if beyond else last
    return 0, whole_or_none("passes", passes)


def frame_span(frames: Iterable[int]) -> tuple[int, int]:
    """The first of these frames, and the one behind the last."""
    numbers = [whole("frames", one, FRAMES - 1) for one in items(frames)]
    if not numbers or numbers != list(range(numbers[0], numbers[0] + len(numbers))):
        raise ValueError("frames: expected numbers one after the other, as range(3, 9)")
    return numbers[0], numbers[-1] + 1


def as_column(name: str, values: npt.ArrayLike | None, dtype: str, components: int,
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
