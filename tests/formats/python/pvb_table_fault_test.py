#!/usr/bin/python3
"""pvb.py on damaged files with tables: never a wrong value, and a named table, chunk and channel."""
import random
import struct

from support import CHANNELS, CODECS, SAMPLES, bits, frames, main, mend, pvb, put, save
from table_support import TABLES, TableTest, columns_of, count_of, make, write


class Damage(TableTest):
    def read(self, path):
        """Checks every value that can be read; returns the texts of those that cannot, or the refusal."""
        try:
            f = pvb.open(path)
        except pvb.Error as error:
            return str(error)
        refused = []
        with f:
            self.assertEqual(f.passes, 6)
            for name, table in f.tables.items():
                for k in range(6):
                    first, count = table.pass_range(k)
                    self.assertEqual(count, count_of(name, k))
                    for channel in table.channels if count else ():
                        try:
                            found = table.read(channel, first, count, codes=True)
                            self.assertEqual(bits(found), bits(columns_of(name, k)[channel]))
                        except pvb.Error as error:
                            refused.append((name, channel, str(error)))
        return refused

    def test_a_flipped_bit_in_a_chunk_names_table_chunk_and_channel(self):
        rng, path, unreadable = random.Random(1), self.path("x.pvb"), 0
        for codec in CODECS:
            data = make(path, 6, codec)
            places = [(offset, length) for kind, offset, length in frames(data) if kind == b"TCHK"]
            self.assertGreater(len(places), 5)
            for offset, length in places:
                name = list(TABLES)[struct.unpack_from("<I", data, offset + 84)[0] - 1]
                for bound in (64 + 32 + 24 * len(TABLES[name]), length) * 8:
                    place = 8 * offset + rng.randrange(8 * bound)
                    changed = bytearray(data)
                    changed[place // 8] ^= 1 << place % 8
                    save(path, bytes(changed))
                    for table, channel, text in self.read(path):
                        self.assertEqual(table, name)
                        self.assertRegex(
                            text, rf"x\.pvb: table {name}: chunk \d+ \(records \d+-\d+\) at byte {offset}: ")
                        unreadable += f"channel {channel}: its checksum" in text
        self.assertGreater(unreadable, 20)

    def test_a_flipped_bit_anywhere_never_gives_a_wrong_value(self):
        rng, path = random.Random(2), self.path("x.pvb")
        data, refused = make(path, 6), 0
        for _ in range(300):
            offset = rng.choice(frames(data))[1]
            place = 8 * offset + rng.randrange(8 * 600)
            changed = bytearray(data)
            changed[place // 8] ^= 1 << place % 8
            save(path, bytes(changed))
            refused += isinstance(self.read(path), str)
        self.assertGreater(refused, 5)

    def test_where_a_commit_of_the_chain_is_lost_chunks_are_found_by_looking(self):
        path = self.path("x.pvb")
        data = make(path, 6, close=False)
        commits = [offset for kind, offset, _ in frames(data) if kind == b"CMIT"]
        chunks = [offset for kind, offset, _ in frames(data) if kind == b"TCHK"]
        lost = put(data, commits[2], b"?")
        with pvb.open(save(path, lost)) as f:
            self.assertTrue(f._scanned)
            self.check(f, 6)
        with pvb.resume(path, CHANNELS, sync=False, tables=TABLES) as w:
            write(w, 6, 7)
        with pvb.open(path) as f:
            self.assertFalse(f._scanned)
            self.check(f, 7)
        both = put(put(lost, chunks[2], b"?"), chunks[1], b"?")  # of pass 2
        self.assertIn("damaged: table vertices: cannot be found: records 15-", self.read(save(path, both)))

    def test_of_a_file_that_a_program_of_version_1_0_copied_all_tables_are_empty(self):
        path = self.path("x.pvb")
        data = make(path, 3, close=False)
        for kind, offset, _ in frames(data):
            if kind == b"CMIT":
                data = mend(put(data, offset + 56, struct.pack("<I", 160)), offset)
        with pvb.open(save(path, data)) as f:
            self.assertEqual((f.records, [table.records for table in f.tables.values()]), (60, [0, 0]))
            self.assertEqual(f.tables["photons"].pass_range(2), (0, 0))
            self.assertEqual(f.tables["photons"]["p"].shape, (0, 3))
        with pvb.resume(path, CHANNELS, sync=False, tables=TABLES) as w:
            write(w, 3, 4)
        with pvb.open(path) as f:
            self.assertEqual(bits(f.tables["vertices"]["g"]), bits(columns_of("vertices", 3)["g"]))

    def test_tables_are_told_by_the_optional_feature_whatever_the_minor_version(self):
        path = self.path("x.pvb")
        data = make(path, 3)
        for minor in (0, 1, 7):
            for features, tables in ((3, 2), (1 << 31 | 2, 2), (1, 0), (0, 0)):
                changed = put(put(data, 66, struct.pack("<H", minor)), 72, struct.pack("<I", features))
                with pvb.open(save(path, mend(changed, 0))) as f:
                    self.assertEqual((len(f.tables), f.records), (tables, 60))
                if minor > 1 or features & ~2:
                    self.fails("cannot resume: written by version", pvb.resume, path, CHANNELS,
                               tables=TABLES if tables else None)
        with pvb.open(f"{SAMPLES}/golden-minor.pvb") as f:
            self.assertEqual((f.version, f.tables, f.records), ((1, 1), {}, 3))

    def test_numbers_that_are_not_possible_are_refused(self):
        path = self.path("x.pvb")
        data = make(path, 6)
        head = 64 + 64 + 64 * len(CHANNELS) + struct.unpack_from("<I", data, 64 + 20)[0]
        self.assertEqual(struct.unpack_from("<I", data, head)[0], 2)
        commit = frames(data)[-1][1]
        marks = [struct.pack("<Q", value) for value in (3, 300, 2**31, 2**32 - 1, 2**59, 2**63, 2**64 - 1)]
        for frame, at, size in ((0, head, 4), (0, head + 8 + 60, 4), (commit, commit + 64 + 160, 4),
                                *((commit, commit + 64 + k, 8) for k in (168, 176, 184, 200, 208, 216))):
            for mark in {mark[:size] for mark in marks}:
                self.assertIsInstance(self.read(save(path, mend(put(data, at, mark), frame))), str, (at, mark))
        for new in (b"photons\0\0", b"paths\0\0\0\0", b"ver ices\0", bytes(9), b"\0"):
            self.assertIsInstance(self.read(save(path, mend(put(data, head + 8, new), 0))), str, new)
        self.assertIsInstance(self.read(save(path, mend(put(data, 56, struct.pack("<I", head - 64 + 5)), 0))), str)
        self.assertIsInstance(self.read(save(path, mend(put(data, commit + 56, b"\xa1\0\0\0"), commit))), str)


if __name__ == "__main__":
    main()
