#!/usr/bin/env python3
"""Reads a path-vertex buffer from formats/README.md alone, with the standard library; shares no code with psf.

Prints a line a channel: name, type, components, encoding, all committed values as hexadecimal bytes. Columns in zstd
are decoded by the program `zstd`.
"""
import struct
import subprocess
import sys
import zlib

MAGIC = b"\x89PVB\r\n\x1a\x01"
TYPES = {1: ("u8", 1), 2: ("u16", 2), 3: ("u32", 4), 4: ("u64", 8), 5: ("f16", 2), 6: ("f32", 4),
         7: ("f64", 8)}


def frame(data, offset, uuid=None):
    """(type, directory, length) of the frame at offset, or None."""
    if offset + 64 > len(data) or data[offset:offset + 8] != MAGIC:
        return None
    own_uuid = data[offset + 8:offset + 24]
    kind, flags = struct.unpack_from("<4sI", data, offset + 24)
    own, length, _, size, crc = struct.unpack_from("<QQQII", data, offset + 32)
    if own != offset or (uuid is not None and own_uuid != uuid) or offset + length > len(data):
        return None
    directory = data[offset + 64:offset + 64 + size]
    if zlib.crc32(directory, zlib.crc32(data[offset:offset + 60])) != crc:
        return None
    if flags & 1 and kind not in (b"HEAD", b"SLOT", b"CHNK", b"CMIT"):
        sys.exit("a frame that must be understood: %r" % kind)
    return kind, directory, length


def decoded(stored, codec, filter_, length):
    """The values of a column, `length` bytes."""
    if codec == 0:
        assert filter_ == 0
        return stored
    assert codec == 1 and filter_ in (0, 1) and len(stored) < length
    plain = subprocess.run(["zstd", "-dcq"], input=stored, stdout=subprocess.PIPE, check=True).stdout
    if filter_ == 0:
        return plain
    n = length // 4
    column = bytearray(plain)
    for k in range(4):
        column[k:4 * n:4] = plain[k * n:(k + 1) * n]
    return bytes(column)


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    kind, directory, length = frame(data, 0) or sys.exit("no HEAD")
    uuid = data[8:24]
    major, _, required, _, _, count, _ = struct.unpack_from("<HHIIIII", directory, 0)
    if kind != b"HEAD" or major != 1 or required:
        sys.exit("not version 1")
    channels = []
    for k in range(count):
        name, code, components, encoding = struct.unpack_from("<56sBBB", directory, 64 + 64 * k)
        channels.append((name.rstrip(b"\0").decode("ascii"), *TYPES[code], components, encoding))

    # Hop from frame to frame; chunks count once a commit follows them.
    columns = [b""] * count
    committed, pending, records = None, [b""] * count, 0
    offset = length
    while offset < len(data):
        found = frame(data, offset, uuid)
        if found is None:
            offset += 4096
            continue
        kind, directory, length = found
        if kind == b"CHNK":
            first, size, _, n = struct.unpack_from("<QIII", directory, 0)
            assert first == records and n == count
            for k in range(n):
                channel, codec, filter_, crc, place, stored = struct.unpack_from(
                    "<HBBIQQ", directory, 32 + 24 * k)
                column = data[offset + place:offset + place + stored]
                assert channel == k and place % 64 == 0 and zlib.crc32(column) == crc
                wanted = size * channels[k][2] * channels[k][3]
                column = decoded(column, codec, filter_, wanted)
                assert len(column) == wanted
                pending[k] += column
            records += size
        elif kind == b"CMIT":
            total, = struct.unpack_from("<Q", directory, 16)
            assert total == records
            committed = total
            columns = list(pending)
        offset += length
    if committed is None:
        sys.exit("no commit")
    for (name, kind, _, components, encoding), column in zip(channels, columns):
        print(name, kind, components, ("plain", "octahedral")[encoding], column.hex())


read(sys.argv[1])
