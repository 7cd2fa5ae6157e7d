"""Values of parameters, passes and columns as the library takes them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Union

import numpy as np
import numpy.typing as npt

Value = Union[str, float, bool, None]  # of a parameter
Passes = Union[int, slice, None]  # the first n, or a slice first:last; None: all


def text(value: Value) -> str:
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or value is False:
        return "off"
    if value is True:
        return "on"
    return value if isinstance(value, str) else f"{value:.17g}"


def texts(given: Mapping[str, Value]) -> dict[str, str]:
    return {name.replace("_", "-"): text(value) for name, value in given.items()}


def lists(given: Mapping[str, Value | Iterable[Value]]) -> dict[str, str]:
    """Lists of values as the commands take them: "2px,4px". A text may be a list or a range."""
    return {name.replace("_", "-"): ",".join(text(one) for one in _as_list(name, value))
            for name, value in given.items()}


def _as_list(name: str, value: Value | Iterable[Value]) -> list[Value]:
    if value is None or isinstance(value, (str, float, int, np.generic)):
        return [value]
    values = list(value)
    if not values:
        raise ValueError(f"{name}: an empty list")
    return values


def with_underscores(row: Mapping[str, Any]) -> dict[str, Any]:
    """Names of parameters as those of keywords."""
    return {name.replace("-", "_"): value for name, value in row.items()}


def pass_range(passes: Passes, all: int) -> tuple[int, int | None]:
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
