#!/usr/bin/env python3
"""Reads and writes path-vertex buffers (.pvb) with numpy; specified by README.md beside this file.

    import pvb

    with pvb.open("scene.pvb") as f:
        f.records, f.passes, f.closed, f.uncommitted_bytes, f.metadata["cameras"]
        position = f["position"]                        # (records, 3) float32
        some = f.read("contribution", first=0, count=1000)
        last = f.read("distance", *f.pass_range(f.passes - 1))

    channels = pvb.standard_channels("normal", "reflectance")
    with pvb.create("new.pvb", channels, {"producer": "me"}, codec="zstd") as w:
        w.append(position=p, throughput=t, contribution=c, distance=d, pixel=i, normal=n,
                 reflectance=r)
        w.commit()                                      # ends a pass; what is committed is safe

Tables, other records under the same passes (version 1.1 of the format):

    vertices = pvb.standard_table("vertices", "normal")
    with pvb.create("new.pvb", channels, tables={"vertices": vertices}) as w:
        w.append(...)
        w.append_to("vertices", path=k, parent=m, position=x, throughput=t, emission=e, direct=d,
                    background=b, normal=n)
        w.commit()
    with pvb.open("new.pvb") as f:
        table = f.tables["vertices"]                    # is to its records what f is to the paths
        last = table.read("position", *table.pass_range(f.passes - 1))

Needs Python 3.9, numpy and a POSIX system; zstd columns need the module zstandard too. Arrays have
the stored type, (records, components) or (records,); octahedral channels are float32 unit vectors
(records, 3). Whatever goes wrong is a pvb.Error whose text names the file and the place.
"""
import concurrent.futures
import contextlib
import errno
import fcntl
import functools
import json
import os
import stat
import struct
import sys
import uuid as uuids
import zlib
from typing import NamedTuple

import numpy as np

try:
    import zstandard
except ImportError:
    zstandard = None

__all__ = ["Channel", "Error", "Reader", "Table", "Writer", "create", "decode_octahedral",
           "encode_octahedral", "open", "resume", "standard_channels", "standard_table"]

MAGIC = b"\x89PVB\r\n\x1a\x01"
PAGE, ALIGNMENT = 4096, 64  # of frames; of columns and sections in a frame
MAX_DIRECTORY, MAX_METADATA, MAX_RESUME = 16 << 20, 1 << 20, 64 << 10
MAX_CHUNK_RECORDS, MAX_CHUNK_BYTES = 1 << 24, 1 << 30
MAX_TABLES, MAX_CHANNELS = 16, 256
HAS_TABLES = 2  # an optional feature of HEAD
INDEX_STEP, INDEX_LEAP = 64, 4096  # which entries a commit repeats: README.md, "The index"
REQUIRED, CLOSED = 1, 1  # flags of a frame, of a commit
RAW, ZSTD = 0, 1

PREFIX = struct.Struct("<8s16s4sIQQQII")
HEAD = struct.Struct("<HHIIIII40x")
CHANNEL = struct.Struct("<56sBBB5x")
SLOT = struct.Struct("<QQQII")
TABLES = struct.Struct("<I4x")  # before the tables in HEAD and in CMIT
TABLE = struct.Struct("<56sII")  # of HEAD
TOTAL = struct.Struct("<QQQ8x")  # of CMIT
CHUNK = struct.Struct("<QIIII8x")
COLUMN = struct.Struct("<HBBIQQ")
COMMIT = struct.Struct("<I4xQQQQQQQQ")
SECTION = struct.Struct("<QQI4x")
COMMIT_SIZE = 160
ENTRY = np.dtype([("offset", "<u8"), ("length", "<u8"), ("first", "<u8"), ("count", "<u4"),
                  ("pass", "<u4")])
TYPES = {"u8": (1, "<u1"), "u16": (2, "<u2"), "u32": (3, "<u4"), "u64": (4, "<u8"),
         "f16": (5, "<f2"), "f32": (6, "<f4"), "f64": (7, "<f8")}
TYPE_NAMES = {code: name for name, (code, _) in TYPES.items()}
ENCODINGS = ("plain", "octahedral")


PATHS = "paths"  # the name of the records that are no table's


class Error(Exception):
    """Bad input, a refused file, a failed system call or wrong use; one line, with the remedy."""


class Channel(NamedTuple):
    name: str
    type: str  # u8 u16 u32 u64 f16 f32 f64
    components: int = 1  # as stored
    encoding: str = "plain"  # or octahedral: u16 x 2

    @property
    def dtype(self):
        return np.dtype(TYPES[self.type][1])

    @property
    def stride(self):  # stored bytes of a record
        return self.dtype.itemsize * self.components

    def check(self):
        name = self.name
        _check_name("channel", name)
        if self.type not in TYPES:
            raise Error(f"channel {name}: unknown type {self.type}")
        if not 1 <= self.components <= 16:
            raise Error(f"channel {name}: {self.components} components; 1 to 16 are possible")
        if self.encoding not in ENCODINGS:
            raise Error(f"channel {name}: unknown encoding {self.encoding}")
        if self.encoding == "octahedral" and (self.type, self.components) != ("u16", 2):
            raise Error(f"channel {name}: an octahedral channel is u16 x 2")


def _check_name(what, name):
    if not 1 <= len(name) <= 56 or any(not "!" <= letter <= "~" for letter in name):
        raise Error(f"a {what}'s name must be 1 to 56 printable ASCII characters without spaces")


REQUIRED_CHANNELS = (Channel("position", "f32", 3), Channel("throughput", "f32", 3),
                     Channel("contribution", "f32", 3), Channel("distance", "f32"),
                     Channel("pixel", "u32"))
OPTIONAL_CHANNELS = (Channel("unfiltered", "f32", 3), Channel("flags", "u8"),
                     Channel("normal", "f32", 3), Channel("reflectance", "f32", 3),
                     Channel("camera", "u16"), Channel("visibility", "u32"),
                     Channel("hit_distance", "f32"), Channel("direction", "f32", 3),
                     Channel("material", "u32"), Channel("roughness", "f32"),
                     Channel("film", "f32", 2), Channel("lens", "f32", 2), Channel("time", "f32"),
                     Channel("frame", "u32"), Channel("alpha", "f32"), Channel("kind", "u8"),
                     Channel("rest_position", "f32", 3))


STANDARD = {  # the required channels of a table, and the others
    PATHS: (REQUIRED_CHANNELS, OPTIONAL_CHANNELS),
    "vertices": (
        (Channel("path", "u32"), Channel("parent", "u32"), Channel("position", "f32", 3),
         Channel("throughput", "f32", 3), Channel("emission", "f32", 3),
         Channel("direct", "f32", 3), Channel("background", "f32", 3)),
        (Channel("distance", "f32"), Channel("depth", "u16"), Channel("kind", "u8"),
         Channel("flags", "u8"), Channel("normal", "f32", 3), Channel("reflectance", "f32", 3),
         Channel("direction", "f32", 3), Channel("outgoing", "f32", 3), Channel("pdf", "f32"),
         Channel("lobe", "u8"), Channel("material", "u32"), Channel("roughness", "f32"),
         Channel("visibility", "u32"))),
    "photons": (
        (Channel("path", "u32"), Channel("position", "f32", 3), Channel("normal", "f32", 3),
         Channel("direction", "f32", 3), Channel("power", "f32", 3)),
        (Channel("depth", "u16"), Channel("light", "u32"), Channel("material", "u32")))}


def standard_channels(*optional, octahedral=(), half=()):
    """The five required channels and the optional ones named, with the types of the specification.
    `octahedral` (vectors of unit length) and `half` (any f32) name those to store smaller."""
    return standard_table(PATHS, *optional, octahedral=octahedral, half=half)


def standard_table(table, *optional, octahedral=(), half=()):
    """The same of a table that the specification describes: vertices or photons."""
    if table not in STANDARD:
        raise Error(f"there is no standard table {table}; there are {', '.join(STANDARD)}")
    required, others = STANDARD[table]
    known = {channel.name: channel for channel in required + others}
    for name in (*optional, *octahedral, *half):
        if name not in known:
            raise Error(f"there is no standard channel {name}; there are {', '.join(known)}")
    wanted = {channel.name for channel in required} | set(optional)
    for name in octahedral:
        known[name] = Channel(name, "u16", 2, "octahedral")
    for name in half:
        known[name] = known[name]._replace(type="f16")
    return [channel for name, channel in known.items() if name in wanted]


# --- octahedral ----------------------------------------------------------------------------------

def decode_octahedral(codes):
    """(n, 2) u16 -> (n, 3) float32, every operation in float32 and in the specified order."""
    one, scale = np.float32(1), np.float32(32767)
    mark = codes == 65535
    x, y = (codes.T.astype(np.float32) - scale) / scale
    z = one - np.abs(x) - np.abs(y)
    fold = z < 0
    folded = (one - np.abs(y)) * np.where(x < 0, -one, one)
    y = np.where(fold, (one - np.abs(x)) * np.where(y < 0, -one, one), y)
    x = np.where(fold, folded, x)
    out = np.stack((x, y, z), axis=-1)
    out /= np.sqrt(x * x + y * y + z * z)[:, None]
    if mark.any():
        out[mark.any(axis=1)] = np.nan
        out[mark.all(axis=1)] = 0
    return out


def encode_octahedral(vectors):
    """(n, 3) -> (n, 2) u16; the zero vector and what is not finite have codes of their own."""
    one = np.float32(1)
    vectors = np.asarray(vectors, np.float32)
    with np.errstate(all="ignore"):
        total = np.abs(vectors[:, 0]) + np.abs(vectors[:, 1]) + np.abs(vectors[:, 2])
        x, y = vectors[:, 0] / total, vectors[:, 1] / total
        folded = (one - np.abs(y)) * np.where(x < 0, -one, one)
        fold = vectors[:, 2] < 0
        y = np.where(fold, (one - np.abs(x)) * np.where(y < 0, -one, one), y)
        x = np.where(fold, folded, x)
        scaled = (np.stack((x, y), axis=-1) + one) * np.float32(32767)
        bad = ~np.isfinite(total) | (total == 0)
        scaled[bad] = 0
    codes = np.floor(scaled.astype(np.float64) + 0.5).astype("<u2")
    codes[bad, 0] = 65535
    codes[bad, 1] = np.where(total[bad] == 0, 65535, 0)
    return codes


# --- columns -------------------------------------------------------------------------------------

def _shuffle(data):
    n = data.size // 4
    out = np.empty_like(data)
    out[:4 * n].reshape(4, n)[:] = data[:4 * n].reshape(n, 4).T
    out[4 * n:] = data[4 * n:]
    return out


def _unshuffle(data, out):
    n = data.size // 4
    out[:4 * n].reshape(n, 4)[:] = data[:4 * n].reshape(4, n).T
    out[4 * n:] = data[4 * n:]


def _need_zstandard(path):
    if zstandard is None:
        raise Error(f"{path}: zstd columns need the Python module zstandard (Debian: apt install "
                    "python3-zstandard); or convert: psf cat --codec raw IN -o OUT")


def _decompress(stored, out):
    """Fills `out` exactly; never decodes more, whatever the bytes promise."""
    done, view = 0, memoryview(out)
    try:
        with zstandard.ZstdDecompressor().stream_reader(stored) as stream:
            while done < len(view):
                got = stream.readinto(view[done:])
                if got == 0:
                    break
                done += got
            whole = done == len(view) and not stream.read(1)
    except zstandard.ZstdError:
        whole = False
    if not whole:
        raise Error("does not decode to the size of its records")


def _encode(codec, data):
    """(codec, filter, stored bytes) of a column; raw where zstd does not make it smaller."""
    if codec == ZSTD and data.size > 1:
        stored = zstandard.ZstdCompressor(level=1).compress(_shuffle(data))
        if len(stored) < data.size:
            return ZSTD, 1, stored
    return RAW, 0, memoryview(data)


# --- files and frames ----------------------------------------------------------------------------

def _align(value, alignment):
    return -(-value // alignment) * alignment


def _record_range(first, count):
    return f"record {first}" if count == 1 else f"records {first}-{first + count - 1}"


@contextlib.contextmanager
def _system(path, action):
    try:
        yield
    except OSError as error:
        raise Error(f"{path}: cannot {action}: {error.strerror or error}") from error


class _Frame(NamedTuple):
    kind: bytes
    flags: int
    offset: int
    length: int
    sequence: int
    uuid: bytes
    directory: bytes
    front: bytes  # prefix and directory

    @property
    def end(self):
        return self.offset + self.length


class _Declared(NamedTuple):
    """A table as HEAD has it; number 0 is the paths."""
    number: int
    name: str
    capacity: int
    channels: dict  # name -> Channel

    @property
    def label(self):  # before texts on its channels and chunks
        return f"table {self.name}: " if self.number else ""


class _Total(NamedTuple):
    """What a commit says of a table."""
    records: int
    chunks: int
    first_chunk: int


class _Commit(NamedTuple):
    frame: _Frame
    flags: int
    number: int
    passes: int
    previous: int
    base: int
    foreign_required: int
    totals: list  # of the paths, then of each table
    index: tuple  # offset, length, checksum, like the next two
    head: tuple
    resume: tuple
    table_indices: list  # arrays of ENTRY


class _File:
    """Positioned reads of whole ranges below the size that the file had when it was opened."""

    def __init__(self, path, descriptor):
        self.path, self.descriptor = path, descriptor
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            self.close()
            raise Error(f"{path}: not a regular file; give the name of a .pvb file")
        self.size = status.st_size

    def close(self):
        if self.descriptor >= 0:
            os.close(self.descriptor)
            self.descriptor = -1

    __del__ = close

    def read_into(self, offset, out):
        view = memoryview(out)
        with _system(self.path, "read"):
            while len(view):
                got = os.preadv(self.descriptor, [view], offset)
                if got == 0:
                    raise Error(f"{self.path}: ends at byte {offset}: it was cut while being read")
                offset, view = offset + got, view[got:]

    def read(self, offset, length):
        out = bytearray(length)
        self.read_into(offset, out)
        return bytes(out)

    def frame(self, offset, uuid=None):
        """The valid frame at `offset`; where there is none, a text that says why."""
        if self.size - offset < PREFIX.size:
            return "the file ends within the first bytes of a frame"
        page = self.read(offset, min(PAGE, self.size - offset))
        magic, own_uuid, kind, flags, own, length, sequence, size, crc = PREFIX.unpack_from(page)
        if magic != MAGIC:
            return "no frame starts here"
        if uuid is not None and own_uuid != uuid:
            return "a frame of another file stands here"
        if own != offset:
            return "a frame from another place of the file stands here"
        if length % PAGE or length < PREFIX.size or size > min(MAX_DIRECTORY, length - PREFIX.size):
            return "the lengths in the frame's first bytes are impossible"
        end = PREFIX.size + size
        if end > self.size - offset:
            return "the file ends within the frame's directory"
        front = page[:end] if end <= len(page) else self.read(offset, end)
        directory = front[PREFIX.size:]
        if zlib.crc32(directory, zlib.crc32(front[:PREFIX.size - 4])) != crc:
            return "checksum of the frame's first bytes and directory is wrong"
        if length > self.size - offset:
            return "the file ends within the frame"
        return _Frame(kind, flags, offset, length, sequence, own_uuid, directory, front)

    def section(self, frame, section):
        offset, length, crc = section
        data = self.read(frame.offset + offset, length)
        if zlib.crc32(data) != crc:
            raise Error("the checksum of a section of it is wrong")
        return data


class _Head:
    """Version, channels, metadata and tables of a HEAD's directory."""

    def __init__(self, directory):
        if len(directory) < 4:
            raise Error("HEAD is too short")
        self.major, self.minor = struct.unpack_from("<HH", directory)
        if self.major != 1:
            self.refuse("whose layout is another")
        if len(directory) < HEAD.size:
            raise Error("HEAD is too short")
        _, _, required, self.optional, capacity, count, length = HEAD.unpack_from(directory)
        if required:
            self.refuse(f"with features that must be understood to read it (bits {required:#x})")
        start = HEAD.size + CHANNEL.size * count
        if not 1 <= count <= MAX_CHANNELS or length > MAX_METADATA or (
                len(directory) < start + length):
            raise Error(f"HEAD: {count} channels, {length} bytes of metadata are not possible")
        self.tables = [_decode_table(directory, HEAD.size, 0, PATHS, capacity, count)]
        self.metadata = directory[start:start + length]
        if self.optional & HAS_TABLES:
            self._decode_tables(directory, start + length)

    def _decode_tables(self, directory, place):
        try:
            count, = TABLES.unpack_from(directory, place)
            place += TABLES.size
            if not 1 <= count <= MAX_TABLES:
                raise Error(f"HEAD: {count} tables; 1 to {MAX_TABLES} are possible")
            for number in range(1, count + 1):
                name, capacity, channels = TABLE.unpack_from(directory, place)
                place += TABLE.size
                if not 1 <= channels <= MAX_CHANNELS:
                    raise Error(f"HEAD: {channels} channels of a table are not possible")
                table = _decode_table(directory, place, number, _decode_name(name), capacity,
                                      channels)
                _check_name("table", table.name)
                if table.name in [other.name for other in self.tables]:
                    raise Error(f"HEAD: two tables have the name {table.name}")
                self.tables.append(table)
                place += CHANNEL.size * channels
        except struct.error:
            raise Error("HEAD is too short for its tables") from None

    def refuse(self, why):
        raise Error(f"written by version {self.major}.{self.minor} of the format, {why}; this "
                    "module reads version 1: use a newer one")


def _decode_name(name):
    name, _, padding = name.partition(b"\0")
    if padding.strip(b"\0"):
        raise Error("HEAD: a name is not padded with zeros")
    return name.decode("latin-1")


def _decode_table(directory, place, number, name, capacity, count):
    """A _Declared whose `count` channels stand at `place`."""
    channels = {}
    for k in range(count):
        entry = CHANNEL.unpack_from(directory, place + CHANNEL.size * k)
        channel = Channel(_decode_name(entry[0]), TYPE_NAMES.get(entry[1], entry[1]), entry[2],
                          ENCODINGS[entry[3]] if entry[3] < 2 else entry[3])
        channel.check()
        channels[channel.name] = channel
    if len(channels) != count:
        raise Error("HEAD: two channels have one name")
    check_capacity(capacity, channels.values())
    return _Declared(number, name, capacity, channels)


def check_capacity(capacity, channels):
    stride = sum(channel.stride for channel in channels)
    if not 1 <= capacity <= MAX_CHUNK_RECORDS or capacity * stride > MAX_CHUNK_BYTES:
        raise Error(f"chunks of {capacity} records of {stride} bytes; a chunk has 1 to "
                    f"{MAX_CHUNK_RECORDS} records and at most {MAX_CHUNK_BYTES >> 20} MiB")


def _decode_totals(directory, tables):
    """[_Total] of the tables and [their indices], from the directory of a commit; nothing where
    they are not possible."""
    if len(directory) == COMMIT_SIZE:  # a program of version 1.0 has copied the paths alone
        return [_Total(0, 0, 0)] * tables, [np.empty(0, ENTRY)] * tables
    first = COMMIT_SIZE + TABLES.size
    place = first + TOTAL.size * tables
    if len(directory) < place or TABLES.unpack_from(directory, COMMIT_SIZE)[0] != tables:
        return None
    totals, indices = [], []
    for t in range(tables):
        totals.append(_Total(*TOTAL.unpack_from(directory, first + TOTAL.size * t)))
        count = totals[t].chunks - totals[t].first_chunk
        if not 0 <= count <= (len(directory) - place) // ENTRY.itemsize:
            return None
        indices.append(np.frombuffer(directory, ENTRY, count, place))
        place += indices[t].nbytes
    return totals, indices


def _decode_commit(frame, tables):
    """Nothing where the frame is no commit whose numbers are possible, of a file of so many
    tables."""
    if not isinstance(frame, _Frame) or frame.kind != b"CMIT" or len(frame.directory) < COMMIT_SIZE:
        return None
    flags, number, records, chunks, passes, previous, base, first_chunk, foreign = (
        COMMIT.unpack_from(frame.directory))
    sections = [SECTION.unpack_from(frame.directory, COMMIT.size + SECTION.size * k)
                for k in range(3)]
    most = (frame.length, 64 + MAX_DIRECTORY, MAX_RESUME)
    for (offset, length, _), limit in zip(sections, most):
        if (length > limit or offset < len(frame.front) or offset % ALIGNMENT
                or offset + length > frame.length):
            return None
    if (sections[0][1] != ENTRY.itemsize * (chunks - first_chunk) or number == 0
            or (first_chunk > 0 and base == 0) or max(base, previous) >= frame.offset):
        return None
    more = _decode_totals(frame.directory, tables) if tables else ([], [])
    if more is None:
        return None
    totals = [_Total(records, chunks, first_chunk), *more[0]]
    if (sum(total.chunks for total in totals) > frame.offset // PAGE  # each takes a page at least
            or (first_chunk == 0 and any(total.first_chunk for total in totals))):
        return None
    return _Commit(frame, flags, number, passes, previous, base, foreign, totals, *sections,
                   more[1])


def _decode_chunk(frame, table):
    """(entry as in the index, [(codec, filter, checksum, place, stored length)]) of a frame that is
    a chunk of this _Declared."""
    directory, channels = frame.directory, table.channels
    if frame.kind != (b"TCHK" if table.number else b"CHNK"):
        raise Error("another frame stands in its place")
    if len(directory) < CHUNK.size + COLUMN.size * len(channels):
        raise Error("its directory is too short")
    first, count, number, columns, owner = CHUNK.unpack_from(directory)
    if table.number and owner != table.number:
        raise Error("a chunk of another table stands in its place")
    if not 1 <= count <= table.capacity or columns != len(channels):
        raise Error(f"{count} records in {columns} columns are not possible")
    out, behind = [], len(frame.front)
    for k, channel in enumerate(channels.values()):
        own, codec, filtered, crc, place, stored = COLUMN.unpack_from(
            directory, CHUNK.size + COLUMN.size * k)
        if (codec, filtered) not in ((RAW, 0), (ZSTD, 0), (ZSTD, 1)):
            raise Error(f"channel {channel.name}: unknown codec {codec} with filter {filtered}")
        decoded = count * channel.stride
        if (own != k or place < behind or place % ALIGNMENT or place + stored > frame.length
                or not (stored == decoded if codec == RAW else stored < decoded)):
            raise Error(f"channel {channel.name}: impossible place or length")
        out.append((codec, filtered, crc, place, stored))
        behind = place + stored
    return (frame.offset, frame.length, first, count, number), out


# --- reading -------------------------------------------------------------------------------------

class Table:
    """The records of a table up to the last commit that its file had when it was opened. What is
    said of "records" in a Reader is said of the paths; a Reader is their table."""

    def __init__(self, file, uuid, declared, passes, records, chunks):
        self.path, self._file, self._uuid, self._declared = file.path, file, uuid, declared
        self.name, self.records, self.passes, self.chunks = declared.name, records, passes, chunks
        self._columns = {}  # the last column of each channel of which a part was read

    @functools.cached_property
    def _pass_bounds(self):
        """(passes + 1,): the first record of each pass, and the number of records."""
        starts = np.searchsorted(self.chunks["pass"], np.arange(self.passes + 1))
        return np.append(self.chunks["first"], np.uint64(self.records))[starts]

    def _fail(self, why):
        raise Error(f"{self.path}: {self._declared.label}{why}")

    @property
    def channels(self):
        """Name -> Channel, in the order of the file."""
        return dict(self._declared.channels)

    @property
    def chunk_capacity(self):
        return self._declared.capacity

    def pass_range(self, k):
        """(first record, number of records) of pass k, counted from 0."""
        if not 0 <= k < self.passes:
            self._fail(f"pass {k} asked for, but the file has {self.passes}")
        first, end = (int(bound) for bound in self._pass_bounds[k:k + 2])
        return first, end - first

    def pass_index(self):
        """(records,) u32: the pass of each record."""
        return np.repeat(self.chunks["pass"], self.chunks["count"])

    # Values.

    def __contains__(self, name):
        return name in self._declared.channels

    def __getitem__(self, name):
        return self.read(name)

    def read(self, name, first=0, count=None, codes=False):
        """Records [first, first + count) of a channel, to the end where no count is given, as an
        array of your own. `codes`: the stored u16 x 2 of an octahedral channel."""
        channel = self._declared.channels.get(name)
        if channel is None:
            self._fail(f"has no channel {name}; it has {', '.join(self._declared.channels)}")
        count = self.records - first if count is None else count
        if first < 0 or count < 0 or first + count > self.records:
            self._fail(f"{count} records from {first} on asked for, but the "
                       f"{'table' if self._declared.number else 'file'} has {self.records}")
        decode = channel.encoding == "octahedral" and not codes
        out = np.empty((count, 3) if decode else (count, channel.components),
                       np.dtype("<f4") if decode else channel.dtype)
        k = list(self._declared.channels).index(name)

        def part(chunk):
            start, length = int(self.chunks[chunk]["first"]), int(self.chunks[chunk]["count"])
            begin, end = max(start, first), min(start + length, first + count)
            to = out[begin - first:end - first]
            if end - begin < length:  # a part of a chunk: another one may follow
                values = self._column(chunk, k)[begin - start:end - start]
            elif decode:
                values = self._load(chunk, k, np.empty((length, 2), "<u2"))
            else:
                self._load(chunk, k, to)
                return
            to[:] = decode_octahedral(values) if decode else values

        if count:
            chunks = range(self._chunk_of(first), self._chunk_of(first + count - 1) + 1)
            _parallel(part, chunks, out.nbytes)
        return out if out.shape[1] > 1 else out.reshape(count)

    def _chunk_of(self, record):
        return int(np.searchsorted(self.chunks["first"], np.uint64(record), side="right")) - 1

    def _column(self, chunk, k):
        found = self._columns.get(k)
        if found is None or found[0] != chunk:
            channel = list(self._declared.channels.values())[k]
            shape = (int(self.chunks[chunk]["count"]), channel.components)
            found = chunk, self._load(chunk, k, np.empty(shape, channel.dtype))
            self._columns[k] = found
        return found[1]

    def _load(self, chunk, k, out):
        """Fills `out` with a whole column whose checksum is right."""
        offset, first, count = (int(self.chunks[chunk][f]) for f in ("offset", "first", "count"))
        name = list(self._declared.channels)[k]
        try:
            columns = self._chunk_columns(chunk)
            codec, filtered, crc, place, stored = columns[k]
            data = out.view("u1").reshape(-1)
            if codec == RAW:
                self._read_checked(offset + place, data, crc, name)
                return out
            _need_zstandard(self.path)
            packed = np.empty(stored, "u1")
            self._read_checked(offset + place, packed, crc, name)
            target = np.empty_like(data) if filtered else data
            try:
                _decompress(packed, target)
            except Error as error:
                raise Error(f"channel {name}: {error}") from None
            if filtered:
                _unshuffle(target, data)
            return out
        except Error as error:
            if str(error).startswith(f"{self.path}: "):
                raise
            self._fail(f"chunk {chunk} ({_record_range(first, count)}) at byte {offset}: {error}; "
                       "'psf verify' names every fault")

    def _read_checked(self, offset, out, crc, name):
        piece, found = 256 << 10, 0  # small enough to be in the cache for the checksum
        for begin in range(0, out.size, piece):
            part = out[begin:begin + piece]
            self._file.read_into(offset + begin, part)
            found = zlib.crc32(part, found)
        if found != crc:
            raise Error(f"channel {name}: its checksum is wrong")

    def _chunk_columns(self, chunk):
        frame = self._file.frame(int(self.chunks[chunk]["offset"]), self._uuid)
        if isinstance(frame, str):
            raise Error(frame)
        entry, columns = _decode_chunk(frame, self._declared)
        if entry != self.chunks[chunk].item():
            raise Error("another chunk stands in its place")
        return columns


class Reader(Table):
    """A path-vertex buffer up to the last commit that it had when it was opened. `tables`: name ->
    Table, in the order of the file."""

    def __init__(self, path):
        self.path = os.fspath(path)
        with _system(self.path, "open"):
            # Without O_NONBLOCK, opening a named pipe would wait for a writer.
            descriptor = os.open(self.path, os.O_RDONLY | os.O_NONBLOCK)
        file = _File(self.path, descriptor)
        try:
            self._open(file)
        except BaseException:
            file.close()
            raise

    def _open(self, file):
        self._file = file
        frame = file.frame(0)
        if isinstance(frame, str):
            start = file.read(0, min(len(MAGIC), file.size))
            if start != MAGIC:
                self._refuse("is no path-vertex buffer; give the name of a .pvb file")
            self._refuse(f"its header cannot be read: {frame}; restore it from a copy or render "
                         "again")
        if frame.kind != b"HEAD" or frame.sequence != 0:
            self._refuse("starts with a frame that is not HEAD; it is no path-vertex buffer")
        try:
            self._head = _Head(frame.directory)
        except Error as error:
            self._refuse(error)
        self._head_frame = frame
        self._uuid = frame.uuid
        self._commit = self._last_commit()
        if self._commit.foreign_required:
            self._refuse(f"written by version {self._head.major}.{self._head.minor} of the format, "
                         "with frames that must be understood to read it; use a newer module")
        indices = self._load_indices()
        self._scanned = indices is None
        if self._scanned:
            indices = self._scan_indices()
        whole = [(file, frame.uuid, declared, self._commit.passes, total.records, index)
                 for declared, total, index in zip(self._head.tables, self._commit.totals, indices)]
        super().__init__(*whole[0])
        self.tables = {each[2].name: Table(*each) for each in whole[1:]}

    def _refuse(self, why):
        raise Error(f"{self.path}: {why}")

    # What the file holds.

    @property
    def metadata(self):
        try:
            metadata = json.loads(self._head.metadata.decode("utf-8"))
        except (ValueError, RecursionError):
            metadata = None
        if not isinstance(metadata, dict):
            self._refuse("the metadata is no JSON object in UTF-8")
        return metadata

    @property
    def closed(self):
        """Whether the producer said that it was done."""
        return bool(self._commit.flags & CLOSED)

    @property
    def uncommitted_bytes(self):
        """Behind the last commit: normal after a kill."""
        return self._file.size - self._commit.frame.end

    @property
    def uuid(self):
        return uuids.UUID(bytes=self._uuid)

    @property
    def version(self):
        return self._head.major, self._head.minor

    @property
    def resume_state(self):
        """What the producer handed to its last commit."""
        try:
            return self._file.section(self._commit.frame, self._commit.resume)
        except Error as error:
            self._refuse(f"resume state of the commit at byte {self._commit.frame.offset}: {error}")

    # Opening: README.md, "Opening".

    def _frame(self, offset):
        return self._file.frame(offset, self._uuid)

    def _hop(self, offset):
        """The valid frames from `offset` on; behind what is none, looks at every page."""
        while offset < self._file.size:
            frame = self._frame(offset)
            if isinstance(frame, str):
                offset += PAGE
                continue
            known = frame.kind in (b"HEAD", b"SLOT", b"CHNK", b"TCHK", b"CMIT")
            if frame.flags & REQUIRED and not known:
                kind = frame.kind.decode("ascii", "replace")
                self._refuse(f"written by version {self._head.major}.{self._head.minor} of the "
                             f"format, with a frame {kind} at byte {offset} that must be "
                             "understood to read it; use a newer module")
            yield frame
            offset = frame.end

    def _slot_records(self):
        frame = self._frame(self._head_frame.end)
        if isinstance(frame, str) or frame.kind != b"SLOT":
            return []
        page = self._file.read(frame.offset, PAGE)
        records = []
        for place in (1024, 2048):
            offset, length, sequence, _, crc = SLOT.unpack_from(page, place)
            if crc == zlib.crc32(page[place:place + SLOT.size - 4]):
                # What lies behind the end of the file, as after a cut, is no promise.
                if offset + length <= self._file.size:
                    records.append((sequence, offset))
        return sorted(records, reverse=True)

    def _last_commit(self):
        last, promised, promised_at = None, 0, 0
        for sequence, offset in self._slot_records():
            last = self._decode_commit(self._frame(offset))
            if last and last.frame.sequence == sequence:
                break
            last = None
            if sequence > promised:
                promised, promised_at = sequence, offset
        for frame in self._hop(last.frame.end if last else self._head_frame.end):
            last = self._decode_commit(frame) or last
        if promised and (last is None or last.frame.sequence < promised):
            records = last.totals[0].records if last else 0
            self._refuse(f"damaged: the commit at byte {promised_at} is unreadable, so the records "
                         f"from {records} on are lost; 'psf verify' names every fault")
        if last is None:
            self._refuse("holds no committed pass: its writer was stopped before the first; render "
                         "again")
        return last

    def _decode_commit(self, frame):
        return _decode_commit(frame, len(self._head.tables) - 1)

    def _indices_of(self, commit):
        """[Its index of the paths, that of each table]; the first is nothing where its checksum is
        wrong."""
        try:
            paths = np.frombuffer(self._file.section(commit.frame, commit.index), ENTRY)
        except Error as error:
            if str(error).startswith(f"{self.path}: "):
                raise
            paths = None
        return [paths, *commit.table_indices]

    def _load_indices(self):
        """The indices of the last commit and of its bases; nothing where one is unreadable."""
        parts, at = [], self._commit
        # Offset and chunks of the newest commit that those of a resume build on.
        self._leap = 0, [0] * len(at.totals)
        while True:
            parts.append(self._indices_of(at))
            if parts[-1][0] is None:
                return None
            if at.totals[0].first_chunk == 0:
                break
            base = self._decode_commit(self._frame(at.base))
            if base is None or any(base_total.chunks != total.first_chunk for base_total, total
                                   in zip(base.totals, at.totals)):
                return None
            at = base
        if at.number % INDEX_LEAP == 0:
            self._leap = at.frame.offset, [total.chunks for total in at.totals]
        indices = [np.concatenate(table[::-1]) for table in zip(*parts)]
        complete = all(map(self._is_complete, self._head.tables, indices))
        return indices if complete else None

    def _is_complete(self, table, index):
        """Each pass has paths, but not each has records of a table."""
        commit, end = self._commit, self._commit.frame.offset
        total = commit.totals[table.number]
        if len(index) != total.chunks:
            return False
        if len(index) == 0:
            return total.records == 0 and (table.number > 0 or commit.passes == 0)
        offset, length, count = index["offset"], index["length"], index["count"].astype(np.uint64)
        if ((count < 1).any() or (count > table.capacity).any() or (offset > end).any()
                or (length > np.uint64(end) - offset).any() or (length < PAGE).any()
                or (offset % np.uint64(PAGE)).any()):
            return False
        behind, last = np.cumsum(count), int(index["pass"][-1])
        step = np.diff(index["pass"].astype(np.int64), prepend=-1)
        passes = (last < commit.passes and (step[1:] >= 0).all() if table.number else
                  last + 1 == commit.passes and step[0] == 1 and (step >= 0).all()
                  and (step <= 1).all())
        return bool(passes and offset[0] >= self._head_frame.end
                    and (offset[1:] >= offset[:-1] + length[:-1]).all()
                    and (index["first"] == behind - count).all() and behind[-1] == total.records)

    def _scan_indices(self):
        """From all valid chunks and indices, where an index of the last commit is unreadable."""
        tables = self._head.tables
        found = [{} for _ in tables]  # of each, entries by their first record
        for frame in self._hop(self._head_frame.end):
            if frame.kind in (b"CHNK", b"TCHK"):
                for table in tables:
                    with contextlib.suppress(Error):
                        entry = _decode_chunk(frame, table)[0]
                        found[table.number].setdefault(entry[2], entry)
            commit = self._decode_commit(frame)
            for entries, part in zip(found, self._indices_of(commit) if commit else ()):
                for entry in part if part is not None else ():
                    entries.setdefault(int(entry["first"]), entry.item())
        return [self._join(*each) for each in zip(tables, found)]

    def _join(self, table, found):
        """The index of a table from the entries found of it."""
        records, following, missing, entries = self._commit.totals[table.number][0], 0, [], []
        for first in sorted(found):
            if first >= records:
                break
            if first > following:
                missing.append(_record_range(following, first - following))
            following = max(following, first + found[first][3])
            entries.append(found[first])
        if following < records:
            missing.append(_record_range(following, records - following))
        if missing:
            self._refuse(f"damaged: {table.label}cannot be found: {', '.join(missing)}; "
                         "'psf verify' names every fault")
        index = np.array(entries, ENTRY)
        if not self._is_complete(table, index):
            self._refuse(f"damaged: {table.label}the totals of the commit at byte "
                         f"{self._commit.frame.offset} do not add up; 'psf verify' names every "
                         "fault")
        return index

    def close(self):
        self._file.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def _parallel(work, items, size):
    """Calls work(item) for all; in threads where the `size` bytes are worth it."""
    if len(items) == 1 or size < 1 << 20:
        for item in items:
            work(item)
        return
    with concurrent.futures.ThreadPoolExecutor(min(len(items), os.cpu_count() or 1)) as pool:
        for _ in pool.map(work, items):
            pass


def open(path):  # noqa: A001: pvb.open is what one looks for
    """A Reader of the file; refuses what is damaged before its last commit."""
    return Reader(path)


# --- writing -------------------------------------------------------------------------------------

class _Filling:
    """A table of a Writer."""

    def __init__(self, declared):
        self.declared = declared
        self.pending = [[] for _ in declared.channels]  # arrays of the chunk being filled
        self.pending_count = 0
        self.index = np.empty(0, ENTRY)  # up to the last commit
        self.new = []  # entries since
        self.records = self.appended = 0  # committed; in chunks that are written

    def take_new(self):
        if self.new:
            self.index = np.concatenate((self.index, np.array(self.new, ENTRY)))
            self.new = []


def _stored(place, channel, values, count):
    """(count, components) as stored. `place`: where errors are."""
    def refuse(why):
        raise Error(f"{place}channel {channel.name}: {why}")

    if channel.encoding == "octahedral":
        if values.shape == (count, 3) and values.dtype.kind == "f":
            return encode_octahedral(values)
        if values.dtype != np.uint16:
            refuse(f"expected ({count}, 3) floats or ({count}, 2) u16 codes, got "
                   f"{values.shape} of {values.dtype}")
    if values.dtype != channel.dtype:
        if values.dtype.kind in "biu" and channel.dtype.kind == "u":
            limit = np.iinfo(channel.dtype).max
            if values.size and (values.min() < 0 or values.max() > limit):
                refuse(f"values from {values.min()} to {values.max()}; {channel.type} holds 0 "
                       f"to {limit}")
        elif values.dtype.kind not in "biuf" or channel.dtype.kind != "f":
            refuse(f"{values.dtype} cannot be stored as {channel.type}")
        with np.errstate(over="ignore"):
            values = values.astype(channel.dtype)
    if values.ndim == 0:
        return np.full((count, channel.components), values)
    if values.shape != (count, channel.components):
        if values.shape != (count,) or channel.components != 1:
            refuse(f"expected ({count}, {channel.components}) values, got {values.shape}")
        values = values.reshape(count, 1)
    return np.ascontiguousarray(values)


class Writer:
    """Made by create() or resume(). The first error sticks: every later call raises it again, and
    the last commit stays readable."""

    def __init__(self, path, descriptor, tables, codec, sync, uuid):
        self.path, self._tables = path, [_Filling(declared) for declared in tables]
        self._descriptor, self._codec, self._sync, self._uuid = descriptor, codec, sync, uuid
        self._name = path  # of the file now
        self._replaced = -1  # holds the lock of a file that the first commit will replace
        self._error = None
        self._end = self._sequence = self._committed_end = 0
        self._commits = self.passes = 0
        # Offset and chunks of commits.
        self._none = self._previous = self._leap = 0, [0] * len(tables)
        self._whole = False  # whether the next commit must carry the whole index
        self._closed = False  # whether the last commit has the flag
        self._front, self._slot = b"", 0
        self.resume_state = b""  # of the last commit

    @property
    def records(self):
        """Committed."""
        return self._tables[0].records

    @property
    def channels(self):
        """Name -> Channel, in the order of the file."""
        return self._tables[0].declared.channels

    @property
    def tables(self):
        """Name -> channels of each table."""
        return {table.declared.name: table.declared.channels for table in self._tables[1:]}

    def append(self, columns=None, **more):
        """Appends records to the current pass: an array for every channel, (n, components) or (n,).
        A single value stands for n equal ones. `columns`: a dict, for names that are no keywords.
        Vectors are encoded where the channel is octahedral; u16 x 2 are taken as codes."""
        self._guard(self._append, PATHS, {**(columns or {}), **more})

    def append_to(self, table, /, columns=None, **more):
        """The same for a table; a pass may have no record of it."""
        self._guard(self._append, table, {**(columns or {}), **more})

    def commit(self, resume_state=b""):
        """Ends the pass, and makes all that was appended part of the file, also after a crash.
        `resume_state`: at most 64 KiB that pvb.resume() gives back."""
        self._guard(self._end_pass, bytes(resume_state))

    def close(self):
        """Says that the file is finished. Records appended since the last commit are an error."""
        self._guard(self._close)

    def _guard(self, call, *arguments):
        if self._error:
            raise self._error
        if self._descriptor < 0:
            raise Error(f"{self.path}: is closed already")
        try:
            with _system(self._name, "write"):
                call(*arguments)
        except Error as error:
            self._error = error
            raise
        except BaseException:
            self._error = Error(f"{self.path}: an earlier call was interrupted")
            raise

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        try:
            if kind is None:
                self.close()
        finally:
            self.abort()

    def abort(self):
        """Ends without closing: the file ends with its last commit, or is removed without one."""
        if self._descriptor < 0:
            return
        with contextlib.suppress(OSError):  # an uncommitted tail is normal
            if self._commits:
                os.ftruncate(self._descriptor, self._committed_end)
            else:
                os.unlink(self._name)
        self._release()

    def _release(self):
        descriptor, self._descriptor = self._descriptor, -1
        self._release_replaced()
        os.close(descriptor)

    def _release_replaced(self):
        if self._replaced >= 0:
            os.close(self._replaced)
            self._replaced = -1

    # Records.

    def _append(self, name, columns):
        table = next((each for each in self._tables if each.declared.name == name), None)
        if table is None:
            raise Error(f"{self.path}: has no table {name}; it has "
                        f"{', '.join(self.tables) or 'none'}")
        channels, place = table.declared.channels, f"{self.path}: {table.declared.label}"
        for channel in columns:
            if channel not in channels:
                raise Error(f"{place}has no channel {channel}; it has {', '.join(channels)}")
        for channel in channels:
            if channel not in columns:
                raise Error(f"{place}no values for channel {channel}")
        columns = {channel: np.asarray(value) for channel, value in columns.items()}
        counts = {len(value) for value in columns.values() if value.ndim}
        if len(counts) != 1:
            raise Error(f"{place}columns of {sorted(counts)} records; they must be equal")
        count, capacity = counts.pop(), table.declared.capacity
        stored = [_stored(place, channel, columns[channel.name], count)
                  for channel in channels.values()]
        done = 0
        while done < count:
            taken = min(count - done, capacity - table.pending_count)
            for pending, column in zip(table.pending, stored):
                part = column[done:done + taken]
                # A whole chunk is written before we return; the caller may change the rest.
                pending.append(part if taken == capacity else part.copy())
            table.pending_count += taken
            done += taken
            if table.pending_count == capacity:
                self._flush(table)

    def _flush(self, table):
        if table.pending_count == 0:
            return
        count, columns, number = table.pending_count, [], table.declared.number
        data = [(parts[0] if len(parts) == 1 else np.concatenate(parts)).view("u1").reshape(-1)
                for parts in table.pending]
        encoded = [None] * len(data)

        def encode(k):
            codec, filtered, stored = _encode(self._codec, data[k])
            encoded[k] = codec, filtered, zlib.crc32(stored), stored

        _parallel(encode, range(len(data)), sum(column.size for column in data))
        place = _align(PREFIX.size + CHUNK.size + COLUMN.size * len(data), ALIGNMENT)
        directory = bytearray(CHUNK.pack(table.appended, count, self.passes, len(data), number))
        for k, (codec, filtered, crc, stored) in enumerate(encoded):
            directory += COLUMN.pack(k, codec, filtered, crc, place, len(stored))
            columns.append((place, stored))
            place = _align(place + len(stored), ALIGNMENT)
        kind, flags = (b"TCHK", 0) if number else (b"CHNK", REQUIRED)
        frame = self._write_frame(kind, flags, directory, columns)
        table.new.append((*frame[:2], table.appended, count, self.passes))
        table.appended += count
        table.pending = [[] for _ in table.pending]
        table.pending_count = 0

    # Commits.

    def _end_pass(self, resume_state):
        if len(resume_state) > MAX_RESUME:
            raise Error(f"{self.path}: {len(resume_state)} bytes of resume state; at most "
                        f"{MAX_RESUME} fit")
        for table in self._tables:
            self._flush(table)
        if self._tables[0].appended == self.records:
            raise Error(f"{self.path}: a pass without records cannot be committed")
        if self.passes == 2**32 - 1:
            raise Error(f"{self.path}: more than 2^32 - 1 passes")
        self.passes += 1
        self.resume_state = resume_state
        self._write_commit(0)

    def _close(self):
        for table in self._tables:
            if table.pending_count or table.appended != table.records:
                raise Error(f"{self.path}: {table.declared.label}records were appended but not "
                            "committed")
        if self._commits == 0:
            raise Error(f"{self.path}: closed without a pass")
        if not self._closed:
            self._write_commit(CLOSED)
        self._release()

    def _choose_base(self, flags):
        """(Offset, chunks) of the commit whose indices the next one builds on: by the rule of
        README.md, "The index", or the next of it with which the tables' indices fit."""
        number, rule = self._commits + 1, (self._none, self._leap, self._previous)
        whole = flags == CLOSED or number % INDEX_LEAP == 0 or self._whole
        for base in rule[0 if whole else 1 if number % INDEX_STEP == 0 else 2:]:
            if COMMIT_SIZE + self._tables_size(base[1]) <= MAX_DIRECTORY:
                return base
        raise Error(f"{self.path}: the tables have more chunks in this pass than a commit can "
                    "name; use larger chunks")

    def _tables_size(self, first):
        if len(self._tables) == 1:
            return 0
        return TABLES.size + sum(TOTAL.size + ENTRY.itemsize * (len(table.index) - start)
                                 for table, start in zip(self._tables[1:], first[1:]))

    def _tables_directory(self, first):
        """What a commit's directory has of the tables; `first`: where their indices start."""
        if len(self._tables) == 1:
            return b""
        out = bytearray(TABLES.pack(len(self._tables) - 1))
        for table, start in zip(self._tables[1:], first[1:]):
            out += TOTAL.pack(table.appended, len(table.index), start)
        for table, start in zip(self._tables[1:], first[1:]):
            out += table.index[start:].tobytes()
        return out

    def _write_commit(self, flags):
        number, paths = self._commits + 1, self._tables[0]
        for table in self._tables:
            table.take_new()
        base, first = self._choose_base(flags)
        sections = (paths.index[first[0]:].tobytes(), self._front, self.resume_state)
        directory = bytearray(COMMIT.pack(flags, number, paths.appended, len(paths.index),
                                          self.passes, self._previous[0], base, first[0], 0))
        tables = self._tables_directory(first)
        place, parts = _align(PREFIX.size + COMMIT_SIZE + len(tables), ALIGNMENT), []
        for section in sections:
            directory += SECTION.pack(place, len(section), zlib.crc32(section))
            parts.append((place, section))
            place = _align(place + len(section), ALIGNMENT)
        directory += bytes(COMMIT_SIZE - len(directory)) + tables
        self._flush_to_disk()
        frame = self._write_frame(b"CMIT", REQUIRED, directory, parts)
        self._flush_to_disk()
        record = SLOT.pack(*frame, 0, 0)[:-4]
        record += struct.pack("<I", zlib.crc32(record))
        self._write(self._slot + (1024 if number % 2 else 2048), [record])
        if self._name != self.path:
            self._appear()
        self._commits, self._committed_end = number, self._end
        for table in self._tables:
            table.records = table.appended
        self._previous = frame[0], [len(table.index) for table in self._tables]
        self._whole, self._closed = False, flags == CLOSED
        if number % INDEX_LEAP == 0 and base == 0:
            self._leap = self._previous

    def _appear(self):
        os.rename(self._name, self.path)
        self._name = self.path
        self._release_replaced()
        if self._sync:
            folder = os.open(os.path.dirname(self.path) or ".", os.O_RDONLY | os.O_DIRECTORY)
            try:
                os.fsync(folder)
            except OSError as error:
                if error.errno != errno.EINVAL:  # some network file systems cannot
                    raise
            finally:
                os.close(folder)

    # Bytes.

    def _start(self, directory):
        self._write_frame(b"HEAD", REQUIRED, directory)
        self._front = os.pread(self._descriptor, PREFIX.size + len(directory), 0)
        self._slot = self._end
        self._write_frame(b"SLOT", 0, b"")

    def _write_frame(self, kind, flags, directory, parts=()):
        """Appends a frame with `parts`, (place, bytes) each. Returns offset, length, sequence."""
        used = parts[-1][0] + len(parts[-1][1]) if parts else PREFIX.size + len(directory)
        frame = self._end, _align(used, PAGE), self._sequence
        prefix = PREFIX.pack(MAGIC, self._uuid, kind, flags, *frame, len(directory), 0)[:-4]
        crc = zlib.crc32(directory, zlib.crc32(prefix))
        front = prefix + struct.pack("<I", crc) + directory
        pieces, at = [front], len(front)
        for place, part in parts:
            pieces += [bytes(place - at), part]
            at = place + len(part)
        pieces.append(bytes(frame[1] - at))
        self._write(self._end, pieces)
        self._end += frame[1]
        self._sequence += 1
        return frame

    def _write(self, offset, pieces):
        views = [memoryview(piece) for piece in pieces if len(piece)]
        while views:
            put = os.pwritev(self._descriptor, views[:1000], offset)
            if put == 0:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            offset += put
            while views and put >= len(views[0]):
                put -= len(views.pop(0))
            if put:
                views[0] = views[0][put:]

    def _flush_to_disk(self):
        if self._sync:
            getattr(os, "fdatasync", os.fsync)(self._descriptor)


def _codec(path, codec):
    if codec not in ("raw", "zstd"):
        raise Error(f"{path}: unknown codec {codec}; there are raw and zstd")
    if codec == "zstd":
        _need_zstandard(path)
    return ZSTD if codec == "zstd" else RAW


def _declare(path, channels, tables, capacity):
    """[_Declared] of the paths and the tables. `capacity`: a number, or a dict by name."""
    out = []
    tables = dict(tables or {})
    if len(tables) > MAX_TABLES:
        raise Error(f"{path}: {len(tables)} tables; at most {MAX_TABLES} are possible")
    for number, (name, given) in enumerate([(PATHS, channels), *tables.items()]):
        given = [Channel(*channel) for channel in given]
        named = {channel.name: channel for channel in given}
        own = capacity.get(name, 65536) if isinstance(capacity, dict) else capacity
        table = _Declared(number, name, own, named)
        try:
            _check_name("table", name)
            if number and name == PATHS:
                raise Error(f"no table can have the name {PATHS}; choose another")
            for channel in given:
                channel.check()
            if not 1 <= len(given) <= MAX_CHANNELS or len(named) != len(given):
                raise Error(f"1 to {MAX_CHANNELS} channels of different names are needed")
            check_capacity(own, given)
        except Error as error:
            raise Error(f"{path}: {table.label}{error}") from None
        out.append(table)
    return out


def _encode_channels(channels):
    return b"".join(CHANNEL.pack(channel.name.encode("ascii"), TYPES[channel.type][0],
                                 channel.components, ENCODINGS.index(channel.encoding))
                    for channel in channels.values())


def _encode_head(tables, metadata):
    paths = tables[0]
    minor, optional = (1, HAS_TABLES) if len(tables) > 1 else (0, 0)
    out = HEAD.pack(1, minor, 0, optional, paths.capacity, len(paths.channels), len(metadata))
    out += _encode_channels(paths.channels) + metadata
    if len(tables) > 1:
        out += TABLES.pack(len(tables) - 1)
    for table in tables[1:]:
        out += TABLE.pack(table.name.encode("ascii"), table.capacity, len(table.channels))
        out += _encode_channels(table.channels)
    return out


def _metadata(path, metadata):
    """A dict, or JSON text to be stored as it is."""
    try:
        text = metadata if isinstance(metadata, str) else json.dumps(
            metadata or {}, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
        data, value = text.encode("utf-8"), json.loads(text)
    except (TypeError, ValueError) as error:
        raise Error(f"{path}: the metadata cannot be stored as JSON: {error}") from error
    if not isinstance(value, dict) or len(data) > MAX_METADATA:
        raise Error(f"{path}: the metadata must be a JSON object of at most {MAX_METADATA} bytes")
    return data, value


def _lock(path, flags, blocked):
    """A descriptor of the file under its lock; nothing where there is no such file."""
    while True:
        try:
            descriptor = os.open(path, flags, 0o666)
        except FileNotFoundError:
            if flags & os.O_CREAT:
                raise
            return -1
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # Whoever had the lock before may have renamed or removed the file meanwhile.
            with contextlib.suppress(FileNotFoundError):
                if os.path.samestat(os.stat(path), os.fstat(descriptor)):
                    return descriptor
            os.close(descriptor)
        except BlockingIOError:
            os.close(descriptor)
            raise Error(f"{blocked}: another process is writing it; wait for it or choose another "
                        "name") from None
        except BaseException:
            os.close(descriptor)
            raise


def create(path, channels, metadata=None, codec="raw", chunk_capacity=65536, sync=True, uuid=None,
           tables=None):
    """A Writer of a new file, which appears under its name with the first commit (until then it is
    `path`.partial). `channels`: of Channel, or (name, type, components, encoding). `sync`: flush to
    the disk at each commit. `tables`: a dict, name -> channels. `chunk_capacity`: most records a
    chunk, or a dict of it by the tables' names and "paths"."""
    path = os.fspath(path)
    code = _codec(path, codec)
    declared = _declare(path, channels, tables, chunk_capacity)
    text, _ = _metadata(path, metadata)
    if not path or (os.path.exists(path) and not os.path.isfile(path)):
        raise Error(f"'{path}': cannot create: not the name of a regular file; choose another")
    # A name as long as the file system takes it is cut: its last part to 255 bytes with ".partial".
    folder, name = os.path.split(os.fsencode(path))
    partial = os.fsdecode(os.path.join(folder, name[:247] + b".partial"))
    with _system(path, "create"):
        descriptor = _lock(partial, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, partial)
        writer = Writer(path, descriptor, declared, code, sync, (uuid or uuids.uuid4()).bytes)
        writer._name = partial
        try:
            # Held until it is replaced, so that nobody goes on writing what is about to vanish.
            writer._replaced = _lock(path, os.O_RDONLY, path)
            os.ftruncate(descriptor, 0)
            writer._start(_encode_head(declared, text))
        except BaseException:
            writer.abort()
            raise
    return writer


def resume(path, channels, metadata=None, codec="raw", sync=True, tables=None):
    """A Writer that goes on behind the last commit of a file, whose resume state it has as
    `resume_state`; closed or not. Refuses where the channels or tables are others, or the
    `scene_hash` of the metadata where they are given. Metadata and chunk capacities stay those of
    the file."""
    path = os.fspath(path)
    code, declared = _codec(path, codec), _declare(path, channels, tables, 1)
    given = None if metadata is None else _metadata(path, metadata)[1]
    with _system(path, "open"):
        descriptor = _lock(path, os.O_RDWR, path)
    if descriptor < 0:
        raise Error(f"{path}: cannot resume: there is no such file; create it")
    try:
        with Reader(path) as reader:
            if reader.version > (1, 1) or reader._head.optional & ~HAS_TABLES:
                raise Error(f"{path}: cannot resume: written by version {reader._head.major}."
                            f"{reader._head.minor} of the format; use a newer module")
            for what, own, wanted in (("channels", reader._head.tables[:1], declared[:1]),
                                      ("tables", reader._head.tables[1:], declared[1:])):
                if [(table.name, list(table.channels.values())) for table in own] != [
                        (table.name, list(table.channels.values())) for table in wanted]:
                    raise Error(f"{path}: cannot resume: its {what} are others; use a new name")
            if given is not None and given.get("scene_hash") != reader.metadata.get("scene_hash"):
                raise Error(f"{path}: cannot resume: it is of another scene; use a new name")
            writer = Writer(path, descriptor, reader._head.tables, code, sync, reader._uuid)
            last, writer.resume_state = reader._commit, reader.resume_state
            writer._front, writer._slot = reader._head_frame.front, reader._head_frame.end
            for table, own in zip(writer._tables, (reader, *reader.tables.values())):
                table.index, table.records, table.appended = own.chunks, own.records, own.records
            writer._leap = reader._leap
            writer._whole, writer._closed = reader._scanned, reader.closed
        writer._end = writer._committed_end = last.frame.end
        writer._sequence, writer._commits = last.frame.sequence + 1, last.number
        writer._previous = last.frame.offset, [total.chunks for total in last.totals]
        writer.passes = last.passes
        with _system(path, "write"):
            os.ftruncate(descriptor, writer._end)
        return writer
    except BaseException:
        os.close(descriptor)
        raise


# --- python3 pvb.py FILE -------------------------------------------------------------------------

def _summary(path):
    with open(path) as reader:
        metadata = reader.metadata
        print(f"{path}: path-vertex buffer {reader.version[0]}.{reader.version[1]}, "
              f"{'closed' if reader.closed else 'not closed'}")
        for key in ("producer", "scene", "integrator", "sampler", "seed"):
            if key in metadata:
                print(f"  {key:<11} {metadata[key]}")
        print(f"  records     {reader.records:,} in {reader.passes:,} passes, "
              f"{len(reader.chunks):,} chunks")
        if reader.uncommitted_bytes:
            print(f"  uncommitted {reader.uncommitted_bytes:,} bytes")
        for camera in metadata.get("cameras", []):
            print(f"  camera      {camera.get('name')}: {camera.get('width')} x "
                  f"{camera.get('height')}")
        for table in (reader, *reader.tables.values()):
            if table is not reader:
                print(f"  table {table.name}: {table.records:,} records, {len(table.chunks):,} "
                      "chunks")
            for channel in table.channels.values():
                note = " octahedral" if channel.encoding == "octahedral" else ""
                print(f"  {channel.name:<20} {channel.type} x {channel.components}{note}")


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(f"usage: {os.path.basename(sys.argv[0])} FILE.pvb")
    try:
        _summary(sys.argv[1])
    except Error as error:
        sys.exit(f"pvb.py: {error}")
