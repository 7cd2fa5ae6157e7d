# The compiled part of the package; see __init__.py.
import collections.abc
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

version: str

class Error(Exception):
    code: int

class Channel:
    @property
    def name(self) -> str: ...
    @property
    def type(self) -> str: ...
    @property
    def components(self) -> int: ...
    @property
    def octahedral(self) -> bool: ...
    @property
    def dtype(self) -> np.dtype[Any]: ...

class Camera:
    def __init__(
        self, name: str, width: int, height: int, angle_per_pixel: float = 0.0
    ) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def angle_per_pixel(self) -> float: ...

class Picture:
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def camera(self) -> str: ...
    @property
    def attributes(self) -> dict[str, str]: ...
    @property
    def layer_names(self) -> list[str]: ...
    def layer(self, name: str) -> npt.NDArray[np.float32]: ...
    def rgb(self, prefix: str = "") -> npt.NDArray[np.float32]: ...
    def png(self, exposure: float) -> bytes: ...
    @property
    def light_layers(self) -> list[str]: ...
    def relight(self, weights: dict[str, tuple[float, float, float]]) -> Picture: ...
    def save(self, path: str) -> None: ...
    @staticmethod
    def read(path: str, layer: str = "") -> Picture: ...
    def error(self, reference: Picture, metric: str) -> float: ...

class FilterResult:
    def take_pictures(self) -> list[Picture]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def passes(self) -> int: ...
    @property
    def blocks(self) -> int: ...
    @property
    def sources(self) -> int: ...
    @property
    def queries(self) -> int: ...
    @property
    def orphans(self) -> int: ...
    @property
    def left_out(self) -> int: ...
    @property
    def neighbors(self) -> float: ...

class Dump:
    def __init__(self, path: str) -> None: ...
    @property
    def path(self) -> str: ...
    @property
    def records(self) -> int: ...
    @property
    def passes(self) -> int: ...
    @property
    def closed(self) -> bool: ...
    @property
    def metadata(self) -> str: ...
    @property
    def channels(self) -> list[Channel]: ...
    @property
    def cameras(self) -> list[Camera]: ...
    def refresh(self) -> bool: ...
    def read(self, channel: Channel, first: int, count: int) -> npt.NDArray[Any]: ...
    def filter(
        self,
        given: Mapping[str, str],
        no_weights: bool,
        passes: tuple[int, int | None],
        max_memory: int | None,
        vertex: str,
        progress: Callable[[int, int], object] | None,
    ) -> FilterResult: ...
    def sweep(
        self,
        reference: Picture,
        lists: Mapping[str, str],
        no_weights: bool,
        metrics: collections.abc.Sequence[str],
        passes: tuple[int, int | None],
        max_memory: int | None,
        camera: int,
        vertex: str,
        progress: Callable[[int, int], object] | None,
    ) -> tuple[list[dict[str, Any]], list[str]]: ...
    def tune(
        self,
        lists: Mapping[str, str],
        no_weights: bool,
        passes: tuple[int, int | None],
        camera: int,
        epsilon: float,
        max_memory: int | None,
        vertex: str,
        progress: Callable[[int, int], object] | None,
    ) -> TuneResult: ...
    def ablate(
        self,
        given: Mapping[str, str],
        no_weights: bool,
        passes: tuple[int, int | None],
        camera: int,
        reference: Picture | None,
        metric: str,
        epsilon: float,
        exposure: float,
        crop: tuple[int, int, int, int],
        columns: int,
        max_memory: int | None,
        vertex: str,
        progress: Callable[[int, int], object] | None,
    ) -> AblationResult: ...
    def explain(
        self,
        pixel: tuple[int, int] | None,
        path: int,
        given: Mapping[str, str],
        no_weights: bool,
        passes: tuple[int, int | None],
        camera: int,
        vertex: str,
        progress: Callable[[int, int], object] | None,
    ) -> Explanation: ...

class Sequence:
    def __init__(self, path: str) -> None: ...
    @property
    def path(self) -> str: ...
    @property
    def frames(self) -> list[int]: ...
    @property
    def cameras(self) -> list[Camera]: ...
    def filter(
        self,
        frame: int,
        given: Mapping[str, str],
        no_weights: bool,
        window: int,
        relit: str,
        positions: str,
        max_memory: int | None,
        vertex: str,
        progress: Callable[[int, int], object] | None,
    ) -> FilterResult: ...

class FlickerResult:
    @property
    def json(self) -> str: ...
    @property
    def rows(self) -> list[dict[str, Any]]: ...
    @property
    def png(self) -> bytes: ...
    def save(self, path: str) -> None: ...

class TuneResult:
    @property
    def json(self) -> str: ...
    @property
    def rows(self) -> list[dict[str, Any]]: ...
    @property
    def best(self) -> dict[str, str]: ...
    @property
    def notes(self) -> list[str]: ...
    def save(self, path: str) -> None: ...

class AblationResult:
    @property
    def json(self) -> str: ...
    @property
    def rows(self) -> list[dict[str, Any]]: ...
    def take_pictures(self) -> list[Picture]: ...
    @property
    def png(self) -> bytes: ...
    @property
    def notes(self) -> list[str]: ...
    def save(self, path: str) -> None: ...

class ConvergeResult:
    @property
    def json(self) -> str: ...
    @property
    def rows(self) -> list[dict[str, Any]]: ...
    @property
    def notes(self) -> list[str]: ...
    def save(self, folder: str) -> None: ...

class Explanation:
    def text(self, rows: int) -> str: ...
    def whole_text(self) -> str: ...
    def json(self) -> str: ...
    def notes(self) -> list[str]: ...
    def save(self, path: str) -> None: ...

class DumpWriter:
    def __init__(
        self,
        path: str,
        cameras: collections.abc.Sequence[Camera],
        channels: collections.abc.Sequence[tuple[str, str, int, bool]],
        compress: bool,
        metadata: str,
    ) -> None: ...
    @property
    def channels(self) -> list[Channel]: ...
    @property
    def records(self) -> int: ...
    @property
    def passes(self) -> int: ...
    def append(self, count: int, arrays: collections.abc.Sequence[npt.NDArray[Any]]) -> None: ...
    def commit_pass(self) -> None: ...
    def close(self) -> None: ...

def parameters() -> list[tuple[str, str, str, str]]: ...
def metric_names() -> list[str]: ...
def converge(
    dumps: collections.abc.Sequence[str],
    reference: Picture,
    lists: Mapping[str, str],
    no_weights: bool,
    passes: int | None,
    camera: int,
    epsilon: float,
    all_metrics: bool,
    times: bool,
    render_json: collections.abc.Sequence[str],
    max_memory: int | None,
    vertex: str,
    progress: Callable[[int, int], object] | None,
) -> ConvergeResult: ...
def flicker(
    sequences: collections.abc.Sequence[tuple[str, collections.abc.Sequence[Picture], str]],
    reference: tuple[str, collections.abc.Sequence[Picture], str],
    first: int,
    last: int | None,
    epsilon: float,
    trim: float,
    exposure: float,
    columns: int,
    progress: Callable[[int, int], object] | None,
) -> FlickerResult: ...
def filter_records(
    cameras: collections.abc.Sequence[Camera],
    given: Mapping[str, str],
    no_weights: bool,
    n: float,
    progress: Callable[[int, int], object] | None,
    position: npt.NDArray[np.float32],
    throughput: npt.NDArray[np.float32],
    contribution: npt.NDArray[np.float32],
    pixel: npt.NDArray[np.uint32],
    distance: npt.NDArray[np.float32] | None,
    unfiltered: npt.NDArray[np.float32] | None,
    normal: npt.NDArray[np.float32] | None,
    reflectance: npt.NDArray[np.float32] | None,
    direction: npt.NDArray[np.float32] | None,
    hit_distance: npt.NDArray[np.float32] | None,
    roughness: npt.NDArray[np.float32] | None,
    visibility: npt.NDArray[np.uint32] | None,
    material: npt.NDArray[np.uint32] | None,
    camera: npt.NDArray[np.uint16] | None,
    flags: npt.NDArray[np.uint8] | None,
    kind: npt.NDArray[np.uint8] | None,
) -> tuple[
    npt.NDArray[np.float32], npt.NDArray[np.uint32], npt.NDArray[np.float32], list[Picture]
]: ...
