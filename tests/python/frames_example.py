"""A program that filters a sequence and measures its flicker: mypy --strict reads it, frames_test.py runs it.

    frames_example.py IN.pvb OUT.####.exr
"""

import sys

import psf


def main(path: str, out: str) -> None:
    sequence = psf.open_sequence(path)
    print(sequence, sequence.cameras[0].name)
    alone = sequence.filter()
    shared = sequence.filter(window=3, relit=None, positions="world", r0="4px", progress=False)
    for frame, picture in zip(sequence.frames, shared):
        picture.save(out.replace("####", f"{frame:04}"))
    last = sequence.filter_all(sequence.frames[-1], window=3, relit=2)[0][0]
    print(last.attributes["psf:relit"])
    study = psf.flicker({"alone": alone, "window 3": out}, alone, frames=sequence.frames, trim=0.01)
    print([row["label"] for row in study.rows], float(study.rows[0]["flicker"]))
    again = psf.flicker(shared, alone, trim=0.01)
    print(float(again.rows[0]["error"]) == float(study.rows[1]["error"]) > 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
