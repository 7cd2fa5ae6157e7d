#!/usr/bin/python3
"""What other tests ask of formats/pvb.py, on the command line.

    pvb_tool.py dump FILE               a line a channel: name, type, components, encoding, values as hexadecimal bytes;
                                        tables as in ../read_pvb.py
    pvb_tool.py golden raw|zstd FILE    writes the golden values (see ../golden.cpp), two passes, closed
    pvb_tool.py tables raw|zstd FILE N  the same, N passes with tables (see ../c/table_file.cpp)
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
        for table in (f, *f.tables.values()):
            if table is not f:
                print("table:", table.name, *(table.pass_range(k)[1] for k in range(f.passes)))
            for channel in table.channels.values():
                stored = table.read(channel.name, codes=True)
                print(*channel, stored.tobytes().hex())


def golden_columns(channels, values):
    """Columns of pvb.Channels; values(k) gives the bytes of the k-th."""
    columns = {}
    for k, channel in enumerate(pvb.Channel(*channel) for channel in channels):
        columns[channel.name] = np.frombuffer(values(k), channel.dtype).reshape(-1, channel.components)
    return columns


def write_golden(codec, path, passes=golden.PASSES, tables=(),
                 source=os.path.join(FOLDER, "../../../sample_data/golden-raw.pvb")):
    with pvb.open(source) as f:
        metadata = f._head.metadata.decode()  # the text as it is, so that the bytes can be compared
    capacity = {"paths": golden.CAPACITY, **{name: golden.TABLES[name][1] for name in tables}}
    done = dict.fromkeys(tables, 0)
    with pvb.create(path, golden.CHANNELS, metadata, codec, capacity, sync=False, uuid=uuid.UUID(golden.UUID),
                    tables={name: golden.table_channels(name) for name in tables}) as w:
        for k in range(passes):
            w.append(golden_columns(golden.CHANNELS, lambda c: golden.values(c, k * golden.PASS, golden.PASS)))
            for name in tables:
                count = golden.table_records(name, k)
                w.append_to(name, golden_columns(golden.table_channels(name), lambda c: golden.table_values(
                    name, c, done[name], count)))
                done[name] += count
            w.commit(b"resume %d" % k)


def write_tables(codec, path, passes):
    write_golden(codec, path, int(passes), golden.TABLES)


def write_floats(path, channel, out):
    with pvb.open(path) as f, open(out, "wb") as file:
        file.write(f[channel].tobytes())


def encode(source, path):
    with pvb.open(source) as f, pvb.create(
            path, [("code", "u16", 2, "octahedral"), ("half", "f16", 3)], codec="raw", sync=False) as w:
        w.append(code=f["vector"], half=f["vector"])
        w.commit()


if __name__ == "__main__":
    verbs = {"dump": dump, "golden": write_golden, "tables": write_tables, "floats": write_floats, "encode": encode}
    try:
        verbs[sys.argv[1]](*sys.argv[2:])
    except pvb.Error as error:
        sys.exit(f"pvb_tool.py: {error}")
