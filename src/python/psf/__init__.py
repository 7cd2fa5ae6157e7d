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
``code`` is the exit code of the command. Long calls release the interpreter lock and end on ^C, and
the calls of other threads go on. They show a bar in a notebook; ``progress=True`` is a bar
everywhere, False none, a function gets what is done and all there is, and a class such as tqdm is a
bar of that kind.
"""

from psf import _psf
from psf._dump import Dump, open
from psf._frames import Flicker, Sequence, flicker, open_sequence
from psf._parameters import Parameter, geomspace, metrics, parameters
from psf._picture import Picture, read_picture
from psf._psf import Camera, Channel, Error
from psf._records import FilteredRecords, filter_records
from psf._rendering import render, render_picture, render_sequence, render_settings
from psf._studies import Ablation, Convergence, Explanation, Figures, Tuning, converge
from psf._writer import DumpWriter, create

__version__: str = _psf.version
__all__ = [
    "Ablation", "Camera", "Channel", "Convergence", "Dump", "DumpWriter", "Error", "Explanation",
    "Figures", "FilteredRecords", "Flicker", "Parameter", "Picture", "Sequence", "Tuning",
    "converge", "create", "filter_records", "flicker", "geomspace", "metrics", "open",
    "open_sequence", "parameters", "read_picture", "render", "render_picture", "render_sequence",
    "render_settings",
]
