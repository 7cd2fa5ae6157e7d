"""The values of the golden files, by the formula of ../golden.cpp in plain Python, and their channels; and tables of
such values, those of ../c/table_file.cpp."""
import math
import struct

CHANNELS = [
    ("position", "f32", 3, "plain"), ("normal", "f32", 3, "plain"), ("reflectance", "f32", 3, "plain"),
    ("throughput", "f32", 3, "plain"), ("contribution", "f32", 3, "plain"), ("unfiltered", "f32", 3, "plain"),
    ("distance", "f32", 1, "plain"), ("pixel", "u32", 1, "plain"), ("flags", "u8", 1, "plain"),
    ("camera", "u16", 1, "plain"), ("visibility", "u32", 1, "plain"), ("hit_distance", "f32", 1, "plain"),
    ("direction", "f32", 3, "plain"), ("material", "u32", 1, "plain"), ("roughness", "f32", 1, "plain"),
    ("golden.normal", "u16", 2, "octahedral"), ("golden.reflectance", "f16", 3, "plain"),
    ("golden.number", "u64", 1, "plain"), ("golden.time", "f64", 1, "plain")]
PASS, PASSES, CAPACITY = 24, 2, 16
RECORDS = PASS * PASSES
UUID = "901de000-0000-4000-8000-000000000001"
SPECIAL = (0x7F800000, 0xFF800000, 0x7FC00000, 0x7FA12345, 0x80000000)
DIRECTIONS = ((0, 0, 1), (0, -1, 0), (0.5, 0.5, math.sqrt(0.5)), (-0.6, 0, -0.8), (0, 0, 0), (-1, 0, 0))
MASK = (1 << 64) - 1


def bits_of(channel, record, component):
    x = (channel * 64 + component) * 1000003 + record + 1
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9 & MASK
    x = (x ^ (x >> 27)) * 0x94D049BB133111EB & MASK
    return x ^ (x >> 31)


def float_bits(channel, record, component):
    bits = bits_of(channel, record, component)
    if bits % 29 == 0:
        return SPECIAL[bits // 29 % len(SPECIAL)]
    return struct.unpack("<I", struct.pack("<f", ((bits >> 40 & 0x3FFF) - 8192) / 4096))[0]


def double_bytes(bits):
    """A third of a float; a NaN keeps sign and payload and becomes quiet, as every processor does it."""
    if bits & 0x7F800000 == 0x7F800000 and bits & 0x7FFFFF:
        wide = (bits >> 31) << 63 | 0x7FF8 << 48 | (bits & 0x7FFFFF) << 29
        return struct.pack("<Q", wide)
    return struct.pack("<d", struct.unpack("<f", struct.pack("<I", bits))[0] / 3)


def octahedral(direction):
    x, y, z = direction
    total = abs(x) + abs(y) + abs(z)
    if total == 0:
        return 65535, 65535
    x, y = x / total, y / total
    if z < 0:
        x, y = (1 - abs(y)) * (-1 if x < 0 else 1), (1 - abs(x)) * (-1 if y < 0 else 1)
    return tuple(int((v + 1) * 32767 + 0.5) for v in (x, y))


def record_bytes(k, record):
    """Stored bytes of record `record` of channel k."""
    _, kind, components, encoding = CHANNELS[k]
    if encoding == "octahedral":
        return struct.pack("<HH", *octahedral(DIRECTIONS[record % len(DIRECTIONS)]))
    out = b""
    for component in range(components):
        bits = bits_of(k, record, component)
        out += {"u8": lambda: struct.pack("<B", bits % 4),
                "u16": lambda: struct.pack("<H", bits % 3),
                "u32": lambda: struct.pack("<I", record % 24 * 7 + (bits >> 60)),
                "u64": lambda: struct.pack("<Q", bits),
                "f16": lambda: struct.pack("<H", bits & 0xFFFF),
                "f32": lambda: struct.pack("<I", float_bits(k, record, component)),
                "f64": lambda: double_bytes(float_bits(k, record, component))}[kind]()
    return out


def values(k, first=0, count=RECORDS):
    return b"".join(record_bytes(k, record) for record in range(first, first + count))


# Name: the numbers of its channels, and most records of a chunk.
TABLES = {"vertices": (tuple(range(len(CHANNELS))), 16), "photons": ((8, 17), 7)}


def table_channels(name):
    return [CHANNELS[k] for k in TABLES[name][0]]


def table_records(name, k):
    """Records of a table in pass k."""
    if name == "vertices":
        return k % 4 * 11
    return 10 if k % 3 == 2 else 0


def table_values(name, channel, first, count):
    """Stored bytes of a channel, counted from 0 in the table."""
    table = list(TABLES).index(name)
    return values(TABLES[name][0][channel], 100000 * (table + 1) + first, count)
