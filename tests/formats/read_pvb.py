#!/usr/bin/env python3
"""Reads a path-vertex buffer from formats/README.md alone, with the standard library; shares no code with psf.

Prints a line a channel: name, type, components, encoding, all committed values as hexadecimal bytes. Then, for each
table, `table:`, its name and the number of its records in each pass, and a line for each of its channels. Columns in
zstd are decoded by the program `zstd`. Chunks and indices that contradict each other end it with an error.
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


def channels_at(directory, place, count):
    """[(name, type, size of the type, components, encoding)]"""
    out = []
    for k in range(count):
        name, code, components, encoding = struct.unpack_from("<56sBBB", directory, place + 64 * k)
        out.append((name.rstrip(b"\0").decode("ascii"), *TYPES[code], components, encoding))
    return out


class Table:
    """The paths, or a table: what its chunks hold, in the order of the file."""

    def __init__(self, name, channels):
        self.name, self.channels = name, channels
        self.columns = [b""] * len(channels)
        self.records, self.entries = 0, []  # of all chunks so far
        self.committed = 0, 0  # records and chunks

    def add(self, data, offset, directory, length, passes):
        """A chunk; `passes` were committed before it."""
        first, size, number, count = struct.unpack_from("<QIII", directory, 0)
        assert first == self.records and number == passes and count == len(self.channels)
        for k, (_, _, bytes_, components, _) in enumerate(self.channels):
            channel, codec, filter_, crc, place, stored = struct.unpack_from("<HBBIQQ", directory, 32 + 24 * k)
            column = data[offset + place:offset + place + stored]
            assert channel == k and place % 64 == 0 and zlib.crc32(column) == crc
            wanted = size * bytes_ * components
            column = decoded(column, codec, filter_, wanted)
            assert len(column) == wanted
            self.columns[k] += column
        self.records += size
        self.entries.append((offset, length, first, size, number))

    def commit(self, records, chunks, first, index):
        """Totals of a commit, and its index, which starts at the chunk `first`."""
        entries = [struct.unpack_from("<QQQII", index, 32 * k) for k in range(chunks - first)]
        assert (records, chunks, entries) == (self.records, len(self.entries), self.entries[first:])
        self.committed = records, chunks

    def dump(self, passes, prefix=""):
        records, chunks = self.committed
        if prefix:
            counts = [sum(e[3] for e in self.entries[:chunks] if e[4] == k) for k in range(passes)]
            print(prefix, self.name, *counts)
        for (name, kind, size, components, encoding), column in zip(self.channels, self.columns):
            values = column[:records * size * components].hex()
            print(name, kind, components, ("plain", "octahedral")[encoding], values)


def tables_of(directory, optional, count, metadata):
    """[The paths, then the tables] that HEAD declares."""
    tables, place = [Table("paths", channels_at(directory, 64, count))], 64 + 64 * count + metadata
    if not optional & 2:
        return tables
    number, place = struct.unpack_from("<I", directory, place)[0], place + 8
    for _ in range(number):
        name, _, count = struct.unpack_from("<56sII", directory, place)
        tables.append(Table(name.rstrip(b"\0").decode("ascii"), channels_at(directory, place + 64, count)))
        place += 64 + 64 * count
    return tables


def commit(data, offset, directory, tables, firsts):
    """Checks a commit against what stands before it. Returns its passes. `firsts`: by the offset of a commit, the
    chunks of each table up to it."""
    records, chunks, passes, _, base, first = struct.unpack_from("<QQQQQQ", directory, 16)
    place, length = struct.unpack_from("<QQ", directory, 72)
    totals = [(records, chunks, first)]
    tables[0].commit(*totals[0], data[offset + place:offset + place + length])
    if len(tables) > 1 and len(directory) > 160:
        place = 168 + 32 * (len(tables) - 1)
        assert struct.unpack_from("<I", directory, 160)[0] == len(tables) - 1
        for t, table in enumerate(tables[1:]):
            totals.append(struct.unpack_from("<QQQ", directory, 168 + 32 * t))
            table.commit(*totals[-1], directory[place:])
            place += 32 * (totals[-1][1] - totals[-1][2])
    elif len(tables) > 1:  # copied by a program of version 1.0
        assert not any(table.records for table in tables[1:])
        totals += [(0, 0, 0)] * (len(tables) - 1)
    assert [total[2] for total in totals] == firsts[base]
    firsts[offset] = [total[1] for total in totals]
    return passes


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    kind, directory, length = frame(data, 0) or sys.exit("no HEAD")
    uuid = data[8:24]
    major, _, required, optional, _, count, metadata = struct.unpack_from("<HHIIIII", directory, 0)
    if kind != b"HEAD" or major != 1 or required:
        sys.exit("not version 1")
    tables = tables_of(directory, optional, count, metadata)

    # Hop from frame to frame; chunks count once a commit follows them.
    passes, firsts = 0, {0: [0] * len(tables)}
    offset = length
    while offset < len(data):
        found = frame(data, offset, uuid)
        if found is None:
            offset += 4096
            continue
        kind, directory, length = found
        if kind == b"CHNK":
            tables[0].add(data, offset, directory, length, passes)
        elif kind == b"TCHK":
            tables[struct.unpack_from("<I", directory, 20)[0]].add(data, offset, directory, length, passes)
        elif kind == b"CMIT":
            passes = commit(data, offset, directory, tables, firsts)
        offset += length
    if len(firsts) == 1:
        sys.exit("no commit")
    tables[0].dump(passes)
    for table in tables[1:]:
        table.dump(passes, "table:")


read(sys.argv[1])
