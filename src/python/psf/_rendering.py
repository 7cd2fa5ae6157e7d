"""Rendering: what psf-render does."""

from __future__ import annotations

import collections.abc
import json
import os
import shutil
import tempfile
import weakref
from collections.abc import Callable, Iterable
from types import ModuleType
from typing import Any, TypeVar, Union

from psf._dump import Dump
from psf._frames import Sequence
from psf._parameters import Parameter
from psf._picture import Picture, read_picture
from psf._progress import Progress, shown
from psf._studies import warn
from psf._values import FileName, file_name, frame_span, items, psf_error, text

Setting = Union[str, float, bool, collections.abc.Sequence[Union[str, float]]]
_Opened = TypeVar("_Opened", Dump, Sequence)


def _renderer() -> ModuleType:
    try:
        from psf import _render
    except ImportError as error:
        raise ImportError(
            "psf.render: this package was built without the renderer, or does not find Embree "
            f"and OpenImageIO ({error}); build it with -DPSF_BUILD_RENDER=ON") from error
    return _render


def _settings(given: dict[str, Setting]) -> list[tuple[str, str]]:
    """Each as the command takes it: size=(256, 256) is "256x256", eye=(0, 2, 6) is "0,2,6"."""
    pairs = []
    for name, value in given.items():
        values = [text(name, one) for one in items(value)]
        name = name.replace("_", "-")
        if name == "channels":
            values = [one for several in values for one in several.split(",")]
        if name in ("camera", "channels"):
            pairs += [(name, one) for one in values]
        else:
            pairs.append((name, ("x" if name == "size" else ",").join(values)))
    return pairs


def _render(scene: str, output: str, images: FileName | Iterable[FileName], resume: bool,
            progress: Progress, given: dict[str, Setting], stacklevel: int) -> dict[str, Any]:
    files = [file_name("image", one) for one in items(images)]
    with shown(progress, "render") as report:
        figures, notes = _renderer().render(scene, output, files, resume, _settings(given), report)
    warn(notes, stacklevel)
    loaded: dict[str, Any] = json.loads(figures)
    return loaded


def _render_into(open: Callable[[str], _Opened], scene: str, output: FileName | None,
                 images: FileName | Iterable[FileName], resume: bool, progress: Progress,
                 given: dict[str, Setting]) -> _Opened:
    """Renders into ``output``, or a file that goes with what is returned, and opens it."""
    if output is not None:
        path = file_name("output", output)
        figures = _render(scene, path, images, resume, progress, given, 5)
        opened = open(path)
    else:
        folder = tempfile.mkdtemp(prefix="psf-")
        try:
            path = os.path.join(folder, os.path.splitext(os.path.basename(scene))[0] + ".pvb")
            figures = _render(scene, path, images, resume, progress, given, 5)
            opened = open(path)
        except BaseException:
            shutil.rmtree(folder)
            raise
        weakref.finalize(opened, shutil.rmtree, folder)
    opened.rendered = figures
    return opened


def render(scene: FileName, output: FileName | None = None, *,
           image: FileName | Iterable[FileName] = (), resume: bool = False,
           progress: Progress = None, **settings: Setting) -> Dump:
    """What ``psf-render`` does: renders a scene into a dump, and opens it.

        dump = psf.render("cornell.json", "cornell.pvb", passes=16, size=(256, 256))

    Without ``output`` the dump is a temporary file, which goes with what is returned. ``image``:
    pictures without filter to write beside it, .exr or .png. ``resume``: go on with a dump that is
    there, after ^C or to add passes. The other settings are those of the command, by the same names
    with underscores: numbers, text, and sequences for sizes, places and colours;
    ``psf.render_settings()`` lists them. ``rendered`` of the dump are the figures that the command
    writes with ``--json``.
    """
    scene = file_name("scene", scene)
    if output is not None and "frames" in settings and "####" in file_name("output", output):
        raise psf_error(2, f"{file_name('output', output)}: a dump a frame; psf.render_sequence() "
                        "renders and opens them")
    return _render_into(Dump, scene, output, image, resume, progress, settings)


def render_sequence(scene: FileName, output: FileName | None = None, *, frames: Iterable[int],
                    image: FileName | Iterable[FileName] = (), resume: bool = False,
                    progress: Progress = None, **settings: Setting) -> Sequence:
    """What ``psf-render --frames`` does: renders frames of a scene that moves, and opens them.

        sequence = psf.render_sequence("lantern.json", "lantern.pvb", frames=range(0, 8), passes=4,
                                       channels=["default", "rest_position"])

    With "####" in ``output``, for the frame's number, it is a dump a frame. ``frames``: one after
    the other without a gap. The rest is that of ``render()``.
    """
    first, last = frame_span(frames)
    return _render_into(Sequence, file_name("scene", scene), output, image, resume, progress,
                        {**settings, "frames": f"{first}:{last}"})


def render_picture(scene: FileName, path: FileName, *, progress: Progress = None,
                   **settings: Setting) -> Picture:
    """What ``psf-render --image`` does without a dump: writes the picture without filter, of one
    camera, and reads it: an EXR. References are made so: ``passes=4096, seed=1``."""
    scene, path = file_name("scene", scene), file_name("path", path)
    if os.path.splitext(path)[1] != ".exr":
        raise psf_error(2, f"{path}: the picture is read back, which needs .exr")
    if "camera" in settings:
        cameras = settings["camera"] = items(settings["camera"])
        if len(cameras) != 1 or cameras[0] == "all":
            raise psf_error(2, "camera: the picture is of one camera; give one name")
    return read_picture(_render(scene, "", path, False, progress, settings, 4)["images"][0])


def render_settings() -> list[Parameter]:
    """Every setting of render() that is the scene's, the sampler's or the integrator's."""
    return [Parameter(name.replace("-", "_"), *rest) for name, *rest in _renderer().options()]
