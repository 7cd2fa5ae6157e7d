#!/usr/bin/python3
"""SSIM and FLIP from their papers, with numpy alone and whole two-dimensional kernels in double.

metrics_oracle.py ssim|flip WIDTH EXPOSURE PIXELS_PER_DEGREE PICTURE REFERENCE OUT
reads (height, width, 3) float32, writes 1 - SSIM or FLIP of every pixel as (height, width) float64.
"""

import sys

import numpy as np

PRIMARIES = np.array([[10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
                      [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
                      [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382]])
WHITE = PRIMARIES @ np.ones(3)


def tone_mapped(linear, exposure):
    x = np.maximum(linear.astype(np.float64) * 2.0**exposure, 0)
    return np.where(x < 0.7, x, 1 - 0.3 * np.exp(-(x - 0.7) / 0.3))


def srgb(linear):
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def correlate(channel, kernel):
    radius = kernel.shape[0] // 2
    height, width = channel.shape
    wide = np.pad(channel, radius, mode="edge")
    result = np.zeros_like(channel)
    for j in range(2 * radius + 1):
        for i in range(2 * radius + 1):
            result += kernel[j, i] * wide[j:j + height, i:i + width]
    return result


def squared_distances(radius):
    y, x = np.mgrid[-radius:radius + 1, -radius:radius + 1].astype(np.float64)
    return x, x**2 + y**2


def ssim_errors(picture, reference):
    _, d_sq = squared_distances(5)
    window = np.exp(-d_sq / (2 * 1.5**2))
    window /= window.sum()
    c1, c2 = 0.01**2, 0.03**2
    channels = []
    for k in range(3):
        x, y = srgb(picture[..., k]), srgb(reference[..., k])
        mean_x, mean_y = correlate(x, window), correlate(y, window)
        var_x = correlate(x * x, window) - mean_x**2
        var_y = correlate(y * y, window) - mean_y**2
        cov = correlate(x * y, window) - mean_x * mean_y
        channels.append((2 * mean_x * mean_y + c1) * (2 * cov + c2) /
                        ((mean_x**2 + mean_y**2 + c1) * (var_x + var_y + c2)))
    return 1 - sum(channels) / 3


def to_opponent(rgb):
    x, y, z = np.moveaxis(rgb @ PRIMARIES.T / WHITE, -1, 0)
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


def from_opponent(luma, cx, cz):
    y = (luma + 16) / 116
    xyz = np.stack([y + cx / 500, y, y - cz / 200], -1) * WHITE
    return np.clip(xyz @ np.linalg.inv(PRIMARIES).T, 0, 1)


def hunt_lab(rgb):
    t = rgb @ PRIMARIES.T / WHITE
    f = np.where(t > (6 / 29)**3, np.cbrt(t), t * 29**2 / (3 * 6**2) + 4 / 29)
    x, y, z = np.moveaxis(f, -1, 0)
    lightness = 116 * y - 16
    hunt = lightness / 100
    return np.stack([lightness, hunt * 500 * (x - y), hunt * 200 * (y - z)], -1)


def hyab(a, b):
    return np.abs(a[..., 0] - b[..., 0]) + np.hypot(a[..., 1] - b[..., 1], a[..., 2] - b[..., 2])


def flip_errors(picture, reference, ppd):
    radius = int(np.ceil(3 * np.sqrt(0.04 / (2 * np.pi**2)) * ppd))
    _, d_sq = squared_distances(radius)

    def sensitivity(*terms):
        kernel = sum(a * np.sqrt(np.pi / b) * np.exp(-np.pi**2 * d_sq / ppd**2 / b)
                     for a, b in terms)
        return kernel / kernel.sum()

    kernels = (sensitivity((1, 0.0047)), sensitivity((1, 0.0053)),
               sensitivity((34.1, 0.04), (13.5, 0.025)))

    sigma = 0.5 * 0.082 * ppd
    x, d_sq = squared_distances(int(np.ceil(3 * sigma)))
    bell = np.exp(-d_sq / (2 * sigma**2))

    def balanced(kernel):
        return np.where(kernel > 0, kernel / kernel[kernel > 0].sum(),
                        kernel / -kernel[kernel < 0].sum())

    detectors = (balanced(-x * bell), balanced((x**2 / sigma**2 - 1) * bell))

    def seen(rgb):
        filtered = [correlate(c, k) for c, k in zip(to_opponent(rgb), kernels)]
        light = (to_opponent(rgb)[0] + 16) / 116
        found = [np.hypot(correlate(light, d), correlate(light, d.T)) for d in detectors]
        return hunt_lab(from_opponent(*filtered)), found

    (color_a, found_a), (color_b, found_b) = seen(picture), seen(reference)
    largest = hyab(hunt_lab(np.array([0.0, 1, 0])), hunt_lab(np.array([0.0, 0, 1])))**0.7
    error = hyab(color_a, color_b)**0.7
    knee = 0.4 * largest
    color = np.where(error < knee, 0.95 * error / knee,
                     0.95 + 0.05 * (error - knee) / (largest - knee))
    feature = np.maximum(*(np.abs(a - b) for a, b in zip(found_a, found_b)))
    return color ** (1 - (feature / np.sqrt(2))**0.5)


def main():
    metric, width, exposure, ppd, picture, reference, out = sys.argv[1:]
    pictures = [tone_mapped(np.fromfile(p, "<f4").reshape(-1, int(width), 3), float(exposure))
                for p in (picture, reference)]
    errors = ssim_errors(*pictures) if metric == "ssim" else flip_errors(*pictures, float(ppd))
    errors.astype("<f8").tofile(out)


if __name__ == "__main__":
    main()
