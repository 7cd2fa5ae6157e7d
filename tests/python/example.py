"""A program that uses the package: mypy --strict reads it, package_test.py runs it.

    example.py IN.pvb REFERENCE.exr OUT.exr
"""

import sys

import numpy as np

import psf


def main(path: str, reference: str, out: str) -> None:
    dump = psf.open(path)
    positions = dump["position"][0:100]
    print(dump, positions.shape, float(np.abs(positions).max()) > 0)
    picture = dump.filter(r0="12px", delta=1 / 3, block="4passes", normal=0.95)
    picture.save(out)
    print(picture.rgb.shape, picture.error(reference) < psf.read_picture(reference).error(reference) + 1)
    rows = dump.sweep(reference, r0=psf.geomspace(2, 32, 3), delta=[0.0, 0.5])
    best = min(rows, key=lambda row: float(row["relMSE"]))
    print(len(rows), best["r0"])
    tuning = dump.tune(r0=["2px", "4px"], block="1pass", progress=False)
    print(dump.filter(**tuning.best).attributes["psf:r0"] == tuning.best["r0"])
    print(psf.converge([dump], reference, r0="4px", times=False).rows[0]["relMSE"] > 0)
    print(str(dump.explain((1, 2), visibility=None)).splitlines()[0])


if __name__ == "__main__":
    main(*sys.argv[1:])
