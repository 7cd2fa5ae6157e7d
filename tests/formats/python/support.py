"""What the tests of pvb.py share: a scratch folder, frames of a file, checksums made right again."""
import os
import shutil
import struct
import sys
import tempfile
import unittest
import zlib

sys.dont_write_bytecode = True
FOLDER = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(FOLDER, "..", "..", "..")
SAMPLES = os.path.join(ROOT, "sample_data")
sys.path.insert(0, os.path.join(ROOT, "formats"))
SKIPPED = 77  # exit code

try:
    import numpy as np
except ImportError:
    print("skipped: needs numpy (Debian: python3-numpy)")
    sys.exit(SKIPPED)

import pvb  # noqa: E402

HAS_ZSTD = pvb.zstandard is not None
CODECS = ("raw", "zstd") if HAS_ZSTD else ("raw",)

# Every type, several components, both encodings.
CHANNELS = [pvb.Channel("a", "u8"), pvb.Channel("b", "u16", 2), pvb.Channel("c", "u32", 16), pvb.Channel("d", "u64"),
            pvb.Channel("e", "f16", 3), pvb.Channel("f", "f32", 3), pvb.Channel("g", "f64", 5),
            pvb.Channel("h", "u16", 2, "octahedral")]


class Test(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="psf-pvb-")
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def files(self):
        return sorted(os.listdir(self.folder))

    def fails(self, text, call, *arguments, **more):
        """The call raises a pvb.Error of one line with this text in it."""
        with self.assertRaises(pvb.Error) as caught:
            call(*arguments, **more)
        self.assertIn(text, str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))


def records_of(first, count, channels=tuple(CHANNELS)):
    """Columns of any bits, and of few different ones in every second record, so that zstd finds something."""
    columns = {}
    for k, channel in enumerate(channels):
        rng = np.random.default_rng([k, first, count])
        data = rng.integers(0, 256, (count, channel.stride), dtype=np.uint8)
        data[::2] = k
        data[1::4] &= 3
        columns[channel.name] = data.view(channel.dtype).reshape(count, channel.components)
    return columns


def load(path):
    with open(path, "rb") as file:
        return file.read()


def save(path, data):
    with open(path, "wb") as file:
        file.write(data)
    return path


def frames(data):
    """[(type, offset, length)] of a file without faults."""
    found, offset = [], 0
    while offset < len(data):
        length, = struct.unpack_from("<Q", data, offset + 40)
        found.append((data[offset + 24:offset + 28], offset, length))
        offset += length
    return found


def mend(data, offset):
    """The same bytes, with the checksum of the frame at `offset` made right again."""
    size, = struct.unpack_from("<I", data, offset + 56)
    checked = data[offset:offset + 60] + data[offset + 64:offset + 64 + size]
    return data[:offset + 60] + struct.pack("<I", zlib.crc32(checked)) + data[offset + 64:]


def put(data, offset, new):
    return data[:offset] + new + data[offset + len(new):]


def bits(array):
    return array.tobytes()


def main():
    unittest.main(verbosity=1)
