#!/usr/bin/env python3
"""Makes the pictures in textures/ from formulas; needs nothing but Python's standard library.

Run it in any folder: it writes beside itself, the same bytes each time (zlib versions permitting).
"""
import math
import pathlib
import struct
import zlib

FOLDER = pathlib.Path(__file__).resolve().parent / "textures"


def write_png(name, width, height, color_at):
    """color_at(x, y) gives (r, g, b) in [0, 255], row 0 at the top; at most 256 different colours."""
    rows = [[tuple(int(max(0, min(255, c))) for c in color_at(x, y)) for x in range(width)] for y in range(height)]
    palette = sorted({color for row in rows for color in row})
    assert len(palette) <= 256, (name, len(palette))
    index = {color: i for i, color in enumerate(palette)}
    data = b"".join(b"\0" + bytes(index[color] for color in row) for row in rows)

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    FOLDER.mkdir(exist_ok=True)
    header = struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)
    (FOLDER / name).write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"PLTE", bytes(c for color in palette for c in color))
        + chunk(b"IDAT", zlib.compress(data, 9)) + chunk(b"IEND", b""))


def noise(*key):
    """A number in [0, 1) that depends on whole numbers."""
    return (zlib.crc32(repr(key).encode()) & 0xFFFF) / 65536


def tone(color, factor):
    """A colour made lighter or darker, in steps that keep the palette small."""
    step = round(factor * 24) / 24
    return tuple(c * step for c in color)


def planks(x, y):
    column, along = x // 16, (y + (x // 16) * 53) % 128
    if x % 16 == 0 or along == 0:
        return 62, 40, 25
    grain = math.sin(0.9 * (x % 16) + 3 * math.sin(along / 23 + column) + 7 * noise(column))
    return tone((176, 122, 74), 0.86 + 0.2 * noise(column, along // 128 + 1) + 0.07 * grain)


def bricks(x, y):
    row = y // 16
    shifted = (x + 16 * (row % 2)) % 128
    if y % 16 < 2 or shifted % 32 < 2:
        return 190, 180, 165
    return tone((168, 76, 54), 0.8 + 0.35 * noise(row, shifted // 32) + 0.06 * noise(x // 2, y // 2, 1))


def wallpaper(x, y):
    u, v = abs(x % 32 - 15.5), abs(y % 32 - 15.5)
    if abs(u + v - 15) < 1.6:
        return 214, 178, 96
    if u * u + v * v < 18:
        return 206, 96, 74
    return (72, 104, 112) if x % 8 else (66, 96, 104)


def carpet(x, y):
    ring = min(x, 127 - x, y, 127 - y) // 8
    colors = [(120, 30, 34), (206, 170, 110), (40, 58, 92), (206, 170, 110)]
    if ring < 4:
        return colors[ring]
    d = (abs(x - 63.5) + abs(y - 63.5)) // 6
    return [(132, 40, 40), (168, 60, 48), (206, 170, 110), (40, 58, 92)][int(d) % 4]


def window(x, y):
    if x < 5 or x > 58 or y < 5 or y > 90 or abs(x - 31.5) < 2 or abs(y - 46) < 2:
        return 20, 16, 12
    # Sky over a horizon of hills.
    hill = 68 - 7 * math.sin(x / 11) - 3 * math.sin(x / 4.3 + 2)
    if y > hill:
        return (96, 128, 72) if y > hill + 9 else (112, 140, 104)
    step = y // 4
    return 150 + 6 * step, 190 + 3.5 * step, 250


def checker(x, y):
    return (224, 220, 210) if (x // 32 + y // 32) % 2 else (58, 62, 70)


def leaf(x, y):
    # A lattice of leaves: white where there is one.
    u, v = (x % 32 - 15.5) / 15.5, (y % 32 - 15.5) / 15.5
    return (255, 255, 255) if abs(u) < 0.85 * (1 - v * v) ** 1.5 else (0, 0, 0)


def studs(x, y):
    # Normals of round studs, green up.
    u, v = (x % 32 - 15.5) / 12, (y % 32 - 15.5) / 12
    steep = 0.8 if u * u + v * v < 1 else 0
    nx, ny = steep * u, -steep * v
    length = math.sqrt(nx * nx + ny * ny + 1)
    # In steps that keep the palette small.
    return tuple(round((c / length + 1) * 127.5 / 17) * 17 for c in (nx, ny, 1))


def ripples(x, y):
    d = math.hypot(x - 31.5, y - 31.5)
    level = 128 + 127 * math.cos(d * 2 * math.pi / 12) * max(0, 1 - d / 32)
    return level, level, level


if __name__ == "__main__":
    write_png("planks.png", 128, 128, planks)
    write_png("bricks.png", 128, 128, bricks)
    write_png("wallpaper.png", 64, 64, wallpaper)
    write_png("carpet.png", 128, 128, carpet)
    write_png("window.png", 64, 96, window)
    write_png("checker.png", 64, 64, checker)
    write_png("leaf.png", 128, 128, leaf)
    write_png("studs.png", 32, 32, studs)
    write_png("ripples.png", 64, 64, ripples)
