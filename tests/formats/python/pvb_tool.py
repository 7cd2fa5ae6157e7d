#!/usr/bin/python3
"""What other tests ask of formats/pvb.py, on the command line.

    pvb_tool.py dump FILE               a line a channel: name, type, components, encoding, values as hexadecimal bytes
    pvb_tool.py golden raw|zstd FILE    writes the golden values (see ../golden.cpp), two passes, closed
    pvb_tool.py floats FILE CHANNEL OUT values as pvb.py gives them, bytes
    pvb_tool.py encode IN OUT           the channel `vector` of IN as octahedral `code` and f16 `half`
"""
import os
import sys
import uuid

sys.dont_write_bytecode = True
FOLDER = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [FOLDER, os.path.join(FOLDER, "..", "..", "..", "formats")]

import numpy as np  # noqa: E402

import golden  # noqa: E402
import pvb  # noqa: E402


def dump(path):
    with pvb.open(path) as f:
        for channel in f.channels.values():
            stored = f.read(channel.name, codes=True)
            print(*channel, stored.tobytes().hex())


def write_golden(codec, path, source=os.path.join(FOLDER, "../../../sample_data/golden-raw.pvb")):
    with pvb.open(source) as f:
        metadata = f._head.metadata.decode()  # the text as it is, so that the bytes can be compared
    channels = [pvb.Channel(*channel) for channel in golden.CHANNELS]
    with pvb.create(path, channels, metadata, codec, golden.CAPACITY, sync=False,
                    uuid=uuid.UUID(golden.UUID)) as w:
        for k in range(golden.PASSES):
            columns = {}
            for number, channel in enumerate(channels):
                data = np.frombuffer(golden.values(number, k * golden.PASS, golden.PASS), channel.dtype)
                columns[channel.name] = data.reshape(golden.PASS, channel.components)
            w.append(columns)
            w.commit(b"resume %d" % k)


def write_floats(path, channel, out):
    with pvb.open(path) as f, open(out, "wb") as file:
        file.write(f[channel].tobytes())


def encode(source, path):
    with pvb.open(source) as f, pvb.create(
            path, [("code", "u16", 2, "octahedral"), ("half", "f16", 3)], codec="raw", sync=False) as w:
        w.append(code=f["vector"], half=f["vector"])
        w.commit()


if __name__ == "__main__":
    verbs = {"dump": dump, "golden": write_golden, "floats": write_floats, "encode": encode}
    try:
        verbs[sys.argv[1]](*sys.argv[2:])
    except pvb.Error as error:
        sys.exit(f"pvb_tool.py: {error}")
