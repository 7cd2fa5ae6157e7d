"""What parameters and metrics there are."""

from __future__ import annotations

import numpy as np

from psf import _psf


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
