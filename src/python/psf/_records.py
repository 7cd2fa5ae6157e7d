"""Records that are in memory."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from psf import _psf
from psf._picture import Picture
from psf._progress import Progress, shown
from psf._psf import Camera
from psf._values import Value, as_column, real, texts


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
                   kind: npt.ArrayLike | None = None,
                   parameters: Mapping[str, Value] = {}, no_weights: bool = False,
                   n: float = 0, progress: Progress = None) -> FilteredRecords:
    """Filters records that are in memory, one block of a record a path, in path order.

    What each array is, and its unit, is in the format's table of channels. ``parameters``: as for
    Dump.filter(), {"r0": "8px", "normal": 0.9}; apart, because weights and channels share names.
    ``n``: samples per pixel accumulated up to the end of the block, for radii that shrink; 0: those
    of the records. It is one block: ``progress`` tells the time, and the end.
    """
    count = len(np.asarray(pixel))

    def column(name: str, values: npt.ArrayLike | None, dtype: str, components: int = 1) -> Any:
        return as_column(name, values, dtype, components, count)

    columns = (
        column("position", position, "f4", 3), column("throughput", throughput, "f4", 3),
        column("contribution", contribution, "f4", 3), column("pixel", pixel, "u4"),
        column("distance", distance, "f4"), column("unfiltered", unfiltered, "f4", 3),
        column("normal", normal, "f4", 3), column("reflectance", reflectance, "f4", 3),
        column("direction", direction, "f4", 3), column("hit_distance", hit_distance, "f4"),
        column("roughness", roughness, "f4"), column("visibility", visibility, "u4"),
        column("material", material, "u4"), column("camera", camera, "u2"),
        column("flags", flags, "u1"), column("kind", kind, "u1"))
    with shown(progress, "filter_records") as report:
        c_bar, neighbors, radius, pictures = _psf.filter_records(
            list(cameras), texts(parameters), no_weights, real("n", n), report, *columns)
    return FilteredRecords(c_bar, neighbors, radius, [Picture(picture) for picture in pictures])
