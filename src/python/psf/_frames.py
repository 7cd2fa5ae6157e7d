"""Sequences of frames: filtered frame by frame, and their flicker."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, Union

from psf import _psf
from psf._picture import Picture, as_picture
from psf._progress import Progress, shown
from psf._psf import Camera
from psf._studies import Figures, camera_number, warn
from psf._values import (FRAMES, FileName, Value, file_name, frame_span, items, real, text, texts,
                         vertex_text, whole, whole_or_none, wrong)

# A picture a frame: the name of files with "####" for the frame's number, or pictures in a list.
Pictures = Union[FileName, Iterable[Union[Picture, FileName]]]


class Sequence:
    """The frames of a sequence, of one dump or of a dump a frame.

        sequence = psf.open_sequence("flight.pvb")          # or "flight.####.pvb", a dump a frame
        pictures = sequence.filter(window=5)                # one a frame
        for frame in sequence.frames:                       # one at a time
            sequence.filter(frame, window=5)[0].save(f"{frame:04}.exr")

    ``rendered``: the figures of psf.render_sequence(), where that made it.
    """

    def __init__(self, path: FileName) -> None:
        self._sequence = _psf.Sequence(file_name("path", path))
        self.rendered: dict[str, Any] | None = None

    @property
    def path(self) -> str:
        return self._sequence.path

    @property
    def frames(self) -> list[int]:
        """The numbers of the frames that there are."""
        return self._sequence.frames

    @property
    def cameras(self) -> list[Camera]:
        return self._sequence.cameras

    def filter_all(self, frames: int | Iterable[int] | None = None, *, window: int = 1,
                   relit: Value = "", positions: str = "", max_memory: int | None = None,
                   vertex: str | None = None, no_weights: bool = False, progress: Progress = None,
                   **parameters: Value) -> list[list[Picture]]:
        """What ``psf filter`` does: of every frame a picture of every camera.

        ``frames``: these, one or several; all unless given. ``window``: share vertices over so many
        frames, an odd number. ``relit``: a ball of another frame counts where the means differ by
        at most so many standard errors; None: always; unless given, as of the command.
        ``positions``: where other frames are searched, at the places of frame 0, "rest", or of now,
        "world"; unless given, "rest" where the dump has rest_position. The rest is that of
        ``Dump.filter()``.
        """
        chosen = self.frames if frames is None else [whole("frames", one, FRAMES)
                                                     for one in items(frames)]
        given, share = texts(parameters), whole("window", window, FRAMES)
        apart = text("relit", relit)  # an empty text: what the command does without it
        pictures = []
        with shown(progress, "filter") as report:
            for number, frame in enumerate(chosen):
                result = self._sequence.filter(
                    frame, given, no_weights, share, apart, _positions(positions),
                    whole_or_none("max_memory", max_memory), vertex_text(vertex),
                    _part(report, number, len(chosen)))
                if number == 0:
                    warn(result.notes)
                pictures.append([Picture(picture) for picture in result.take_pictures()])
        return pictures

    def filter(self, frames: int | Iterable[int] | None = None, camera: str | None = None, *,
               window: int = 1, relit: Value = "", positions: str = "",
               max_memory: int | None = None, vertex: str | None = None, no_weights: bool = False,
               progress: Progress = None, **parameters: Value) -> list[Picture]:
        """What ``psf filter --window`` does: of every frame the picture of a camera, the first
        unless named. ``filter_all()`` says what the arguments are."""
        number = camera_number(self, camera)
        all = self.filter_all(frames, window=window, relit=relit, positions=positions,
                              max_memory=max_memory, vertex=vertex, no_weights=no_weights,
                              progress=progress, **parameters)
        return [pictures[number] for pictures in all]

    def __repr__(self) -> str:
        return f"<psf.Sequence {self.path}: {len(self.frames)} frames from {self.frames[0]} on>"


def open_sequence(path: FileName) -> Sequence:
    """Opens the frames of a dump that ``psf-render --frames`` wrote, or of a dump a frame: then the
    name has "####" for the frame's number."""
    return Sequence(path)


class Flicker(Figures):
    """What flicker() gives: the figures of ``psf flicker --json``. It shows itself in a notebook as
    the sheet of some frames of each sequence, and of where it flickers.

    ``rows``: a dict for each sequence: label, error, flicker, left_out.
    """

    def __init__(self, result: _psf.FlickerResult) -> None:
        super().__init__(result.json)
        self._result = result
        self.rows = result.rows

    def save(self, path: FileName) -> None:
        """Writes the sheet, the bytes of ``psf flicker --sheet``."""
        self._result.save(file_name("path", path))

    def _repr_png_(self) -> bytes:
        return self._result.png

    def __repr__(self) -> str:
        rows = "; ".join(f"{row['label']}: error {row['error']:.4g}, flicker {row['flicker']:.4g}"
                         for row in self.rows)
        return f"<psf.Flicker of frames {self['first']}:{self['last']}: {rows}>"


def flicker(pictures: Pictures | Mapping[str, Pictures], reference: Pictures, *,
            frames: Iterable[int] | None = None, epsilon: float = 0.01, trim: float = 0,
            exposure: float = 0, columns: int = 4, progress: Progress = None) -> Flicker:
    """What ``psf flicker`` does: the error of a sequence of pictures against a reference a frame,
    and how much it changes from frame to frame.

        alone, shared = sequence.filter(), sequence.filter(window=5)
        psf.flicker({"alone": alone, "window 5": shared}, "truth.####.exr").rows

    A sequence is the name of EXRs with "####" for the frame's number, which are read one after the
    other, or a list of pictures and names, one a frame; several are a dict by their labels.
    ``frames``: their numbers, one after the other without a gap, as ``range(3, 9)``; unless given,
    0 on, as far as the reference goes. ``trim``: leave out this share of the pixels, where error
    and flicker are largest. ``exposure``: of the sheet, stops; ``columns``: frames of a row of it.
    """
    rows = pictures if isinstance(pictures, Mapping) else {"": pictures}
    first, last = (0, None) if frames is None else frame_span(frames)
    with shown(progress, "flicker") as report:
        result = _psf.flicker([_sequence("pictures", of, label) for label, of in rows.items()],
                              _sequence("reference", reference, "reference"), first, last,
                              real("epsilon", epsilon), real("trim", trim),
                              real("exposure", exposure), whole("columns", columns, FRAMES),
                              report)
    return Flicker(result)


def _positions(value: object) -> str:
    if isinstance(value, str):
        return value
    raise wrong("positions", "'rest' or 'world'", value)


def _part(report: Callable[[int, int], object] | None, number: int,
          count: int) -> Callable[[int, int], object] | None:
    """Reports one of ``count`` calls as a part of the whole."""
    if report is None:
        return None
    whole_report = report
    return lambda done, total: whole_report(number * total + done, count * total)


def _sequence(name: str, value: Pictures, label: str) -> tuple[str, list[_psf.Picture], str]:
    if not isinstance(label, str):
        raise wrong(name, "labels that are text", label)
    try:
        return file_name(name, value), [], label
    except TypeError:
        if isinstance(value, Picture) or not isinstance(value, Iterable):
            raise wrong(name, "a name with ####, or a list of pictures", value) from None
    return "", [as_picture(name, one)._picture for one in value], label
