"""Pictures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from psf import _psf
from psf._values import FileName, file_name, real, wrong


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
    def alpha(self) -> npt.NDArray[np.float32] | None:
        """Alpha, (height, width): of a dump that has it, else None. ``rgb`` is then premultiplied,
        and ``rgb + background`` is what ``save()`` to a PNG and ``error()`` look at."""
        return self["A"] if "A" in self.layers else None

    @property
    def background(self) -> npt.NDArray[np.float32] | None:
        """The background that alpha keeps apart from the colours, (height, width, 3), else None."""
        return self._picture.rgb("background.") if "background.R" in self.layers else None

    @property
    def neighbors(self) -> npt.NDArray[np.float32]:
        """The mean number of records averaged, (height, width)."""
        return self["neighbors.Y"]

    @property
    def radius(self) -> npt.NDArray[np.float32]:
        """The mean radius in world units, (height, width)."""
        return self["radius.Y"]

    @property
    def light_layers(self) -> list[str]:
        """The names of the layers of the light, which add up to the colours; empty: none."""
        return self._picture.light_layers

    def relight(self, /, **weights: float | Sequence[float]) -> Picture:
        """Each layer of the light that is named times its weight, a number or three, and the
        colours with it: what ``psf relight`` does. ``**{"key-light": 2}`` for other names.
        A picture of ``read_picture()`` has its colours alone."""
        return Picture(self._picture.relight(
            {layer: _weight(layer, weight) for layer, weight in weights.items()}))

    def error(self, reference: Picture | FileName, metric: str = "relMSE") -> float:
        """The error against a reference, a picture or an EXR file, by a metric of ``metrics()``."""
        return self._picture.error(as_picture("reference", reference)._picture, metric)

    def save(self, path: FileName) -> None:
        """Writes an EXR with all layers, or a PNG to look at: the bytes of ``psf filter -o``."""
        self._picture.save(file_name("path", path))

    def png(self, exposure: float = 0) -> bytes:
        """The bytes of a PNG to look at: times 2^exposure, tone-mapped; those of save() at 0."""
        return self._picture.png(real("exposure", exposure))

    def _repr_png_(self) -> bytes:
        return self.png()

    def __repr__(self) -> str:
        name = f" of {self.camera}" if self.camera else ""
        return f"<psf.Picture{name}, {self.width} x {self.height}: {', '.join(self.layers)}>"


def _weight(layer: str, value: float | Sequence[float]) -> tuple[float, float, float]:
    if isinstance(value, Sequence) or isinstance(value, np.ndarray):
        if len(value) != 3:
            raise wrong(layer, "a number or three", value)
        red, green, blue = (real(layer, one) for one in value)
        return red, green, blue
    grey = real(layer, value)
    return grey, grey, grey


def as_picture(name: str, value: Picture | FileName) -> Picture:
    """A picture as it is, or that of a file."""
    if isinstance(value, Picture):
        return value
    try:
        path = file_name(name, value)
    except TypeError:
        raise wrong(name, "a psf.Picture or a file name", value) from None
    return read_picture(path)


def read_picture(path: FileName, layer: str = "") -> Picture:
    """Reads the colours of an EXR, with their background: its root or the layer of this name."""
    return Picture(_psf.Picture.read(file_name("path", path), layer))
