"""What the tests of tables share: files with two tables, and what they must hold."""
import uuid

from support import CHANNELS, Test, bits, load, pvb, records_of

TABLES = {"vertices": CHANNELS, "photons": [("p", "f32", 3), ("light", "u32")]}
CAPACITY = {"paths": 16, "vertices": 20, "photons": 7}
UUID = uuid.UUID(int=5)


def count_of(table, k):
    """Records of a table in pass k."""
    return k % 4 * 15 if table == "vertices" else 12 if k % 3 == 2 else 0


def columns_of(table, k):
    channels = tuple(pvb.Channel(*channel) for channel in TABLES.get(table, CHANNELS))
    return records_of(1000 * k + sum(map(ord, table)), count_of(table, k), channels)


def write(w, first, last):
    for k in range(first, last):
        w.append(records_of(20 * k, 20))
        for table in TABLES:
            columns, half = columns_of(table, k), count_of(table, k) // 2
            w.append_to(table, {name: column[:half] for name, column in columns.items()})
            w.append_to(table, {name: column[half:] for name, column in columns.items()})
        w.commit(b"%d" % k)


def make(path, passes, codec="raw", close=True):
    w = pvb.create(path, CHANNELS, {"scene_hash": "s"}, codec, CAPACITY, False, UUID, TABLES)
    write(w, 0, passes)
    if close:
        w.close()
    w.abort()
    return load(path)


class TableTest(Test):
    def check(self, f, passes):
        """The file holds these passes and nothing else."""
        self.assertEqual((f.passes, f.records, list(f.tables)), (passes, 20 * passes, list(TABLES)))
        paths = [records_of(20 * k, 20) for k in range(passes)]
        for name in f.channels:
            self.assertEqual(bits(f.read(name, codes=True)), b"".join(bits(part[name]) for part in paths))
        for name, table in f.tables.items():
            parts = [columns_of(name, k) for k in range(passes)]
            self.assertEqual(table.records, sum(count_of(name, k) for k in range(passes)))
            self.assertEqual([table.pass_range(k)[1] for k in range(passes)],
                             [count_of(name, k) for k in range(passes)])
            for channel in table.channels:
                self.assertEqual(bits(table.read(channel, codes=True)),
                                 b"".join(bits(part[channel]) for part in parts), (name, channel))
