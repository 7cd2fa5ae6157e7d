#!/usr/bin/python3
"""pvb.py on files that are cut, damaged, of other versions or no path-vertex buffers: never a wrong value.

With --long: twenty times the random faults.
"""
import os
import random
import struct
import sys

from support import CHANNELS, CODECS, SAMPLES, Test, bits, frames, load, main, mend, np, pvb, put, records_of, save

PASSES = (40, 7, 64, 33)
LONG = "--long" in sys.argv
CUTS, FLIPS, PAGES = (n * (20 if LONG else 1) for n in (100, 400, 100))  # of each file, besides the places chosen


class Fault(Test):
    def make(self, codec="raw", close=True):
        """(bytes, {channel: stored bytes}) of a file of four passes."""
        path, first = self.path("whole.pvb"), 0
        expected = {channel.name: b"" for channel in CHANNELS}
        w = pvb.create(path, CHANNELS, codec=codec, chunk_capacity=32, sync=False)
        for count in PASSES:
            columns = records_of(first, count)
            w.append(columns)
            w.commit()
            first += count
            for name, column in columns.items():
                expected[name] += bits(column)
        if close:
            w.close()
        w.abort()
        return load(path), expected

    def read(self, data):
        """(records, {channel: stored bytes, or nothing where they are refused}) or the refusal."""
        path = save(self.path("x.pvb"), data)
        try:
            with pvb.open(path) as f:
                columns = {}
                for name in f.channels:
                    try:
                        columns[name] = bits(f.read(name, codes=True))
                    except pvb.Error:
                        columns[name] = None
                return f.records, columns
        except pvb.Error as error:
            self.assertTrue(str(error).startswith(path), error)
            return str(error)

    def check_values(self, result, expected, what):
        """What is read is right. Returns whether all of it could be read."""
        if isinstance(result, str):
            return False
        records, columns = result
        for channel in CHANNELS:
            found = columns[channel.name]
            if found is not None:
                self.assertTrue(found == expected[channel.name][:records * channel.stride], (what, channel))
        return all(found is not None for found in columns.values())

    def test_a_cut_file_holds_the_records_of_the_last_commit_before_the_cut(self):
        for codec in CODECS:
            data, expected = self.make(codec)
            ends, records = [], 0
            for kind, offset, length in frames(data):
                if kind == b"CHNK":
                    records += struct.unpack_from("<I", data, offset + 64 + 8)[0]
                elif kind == b"CMIT":
                    ends.append((offset + length, records))
            places = {random.Random(7).randrange(len(data)) for _ in range(CUTS)}
            for _, offset, length in frames(data):
                places |= {offset, offset + 1, offset + 64, offset + length - 1}
            for place in sorted(places):
                result = self.read(data[:place])
                committed = [count for end, count in ends if end <= place]
                if not committed:
                    self.assertIsInstance(result, str)
                    continue
                self.assertTrue(self.check_values(result, expected, place), place)
                self.assertEqual(result[0], committed[-1])

    def test_a_flipped_bit_never_gives_a_wrong_value(self):
        rng = random.Random(8)
        for codec in CODECS:
            data, expected = self.make(codec)
            places = [rng.randrange(8 * len(data)) for _ in range(FLIPS)]
            for _, offset, _ in frames(data):  # the frames' own bytes more often than their columns
                places += [8 * offset + rng.randrange(8 * 512) for _ in range(25)]
            outcomes = {True: 0, False: 0}
            for place in places:
                changed = bytearray(data)
                changed[place // 8] ^= 1 << place % 8
                result = self.read(bytes(changed))
                outcomes[self.check_values(result, expected, place)] += 1
                if not isinstance(result, str):
                    self.assertEqual(result[0], sum(PASSES))
            self.assertGreater(min(outcomes.values()), 20)

    def test_zeroed_swapped_and_doubled_pages_never_give_a_wrong_value(self):
        rng = random.Random(9)
        for codec in CODECS:
            data, expected = self.make(codec)
            pages = [data[k:k + 4096] for k in range(0, len(data), 4096)]
            for _ in range(PAGES):
                changed = list(pages)
                a, b = rng.randrange(len(pages)), rng.randrange(len(pages))
                kind = rng.randrange(4)
                if kind == 0:
                    changed[a] = bytes(4096)
                elif kind == 1:
                    changed[a], changed[b] = changed[b], changed[a]
                elif kind == 2:
                    changed[a] = changed[b]
                else:
                    del changed[a]
                self.check_values(self.read(b"".join(changed)), expected, (kind, a, b))

    def test_one_bad_column_leaves_all_others_readable_and_is_named(self):
        data, expected = self.make()
        chunk = [offset for kind, offset, _ in frames(data) if kind == b"CHNK"][3]
        place, = struct.unpack_from("<Q", data, chunk + 64 + 32 + 24 * 5 + 8)
        path = save(self.path("x.pvb"), put(data, chunk + place, b"\xAA"))
        with pvb.open(path) as f:
            self.fails(f"{path}: chunk 3 (records 47-78) at byte {chunk}: channel f: its checksum is wrong; "
                       "'psf verify' names every fault", f.read, "f")
            self.fails("checksum is wrong", f.read, "f", 50, 1)
            self.assertEqual(bits(f.read("f", 0, 47)), expected["f"][:12 * 47])
            self.assertEqual(bits(f.read("f", 79)), expected["f"][12 * 79:])
            self.assertEqual(bits(f["g"]), expected["g"])

    def test_a_lost_commit_and_lost_chunks_are_damage(self):
        data, _ = self.make(close=False)
        commits = [offset for kind, offset, _ in frames(data) if kind == b"CMIT"]
        chunks = [offset for kind, offset, _ in frames(data) if kind == b"CHNK"]
        last = self.read(put(data, commits[-1], b"?"))
        self.assertIn(f"damaged: the commit at byte {commits[-1]} is unreadable, so the records from 111 on", last)
        # The index is lost with one commit of the chain; all chunks are there.
        self.assertEqual(self.read(put(data, commits[1], b"?"))[0], sum(PASSES))
        both = put(put(data, commits[1], b"?"), chunks[2], b"?")
        self.assertIn("damaged: cannot be found: records 40-46", self.read(both))

    def test_versions(self):
        data, expected = self.make()
        head = 64  # directory of HEAD
        self.assertTrue(self.check_values(self.read(mend(put(data, head + 2, b"\x07"), 0)), expected, "minor"))
        self.assertTrue(self.check_values(self.read(mend(put(data, head + 8, b"\xFD"), 0)), expected, "optional"))
        self.assertIn("written by version 2.0 of the format", self.read(mend(put(data, head, b"\x02"), 0)))
        self.assertIn("written by version 1.0 of the format, with features that must be understood to read it "
                      "(bits 0x4)", self.read(mend(put(data, head + 4, b"\x04"), 0)))
        chunk = [offset for kind, offset, _ in frames(data) if kind == b"CHNK"][0]
        # The slot leads past a frame in the middle: hop from the start.
        slot = frames(data)[1][1]
        hopped = put(data, slot + 1024, bytes(2048))
        foreign = mend(put(hopped, chunk + 24, b"NEW1"), chunk)
        self.assertIn("with a frame NEW1", self.read(foreign))
        skipped = self.read(mend(put(foreign, chunk + 28, b"\x00"), chunk))
        self.assertEqual(skipped[0], sum(PASSES))  # the index still names it, and its records are refused
        self.assertEqual(set(skipped[1].values()), {None})
        last = [offset for kind, offset, _ in frames(data) if kind == b"CMIT"][-1]
        self.assertIn("with frames that must be understood", self.read(mend(put(data, last + 64 + 64, b"\x01"), last)))

    def test_numbers_that_are_not_possible_are_refused(self):
        data, _ = self.make()
        marks = [struct.pack("<Q", value) for value in (0, 1, 2**31, 2**32 - 1, 2**32, 2**63, 2**64 - 1)]
        _, chunk, _ = [frame for frame in frames(data) if frame[0] == b"CHNK"][2]
        _, commit, _ = frames(data)[-1]
        fields = [(0, 64 + k) for k in range(0, 24, 2)] + [(0, 128 + 56 + k) for k in range(3)]
        fields += [(chunk, 64 + k) for k in (0, 8, 12, 16, 32, 34, 35, 36, 40, 48)] + [(chunk, 40), (chunk, 48)]
        fields += [(commit, 64 + k) for k in range(8, 144, 8)] + [(commit, 40), (commit, 48)]
        for frame, field in fields:
            for mark in marks:
                for size in (2, 8):
                    self.read(mend(put(data, frame + field, mark[:size]), frame))  # lets nothing but pvb.Error out

    def test_a_column_that_decodes_to_more_is_refused(self):
        if "zstd" not in CODECS:
            self.skipTest("needs python3-zstandard")
        path = self.path("x.pvb")
        original, pvb._encode = pvb._encode, None
        try:
            for data in (bytes(1 << 20), bytes(100), b"", bytes(4095)):
                for sized in (True, False):
                    packed = pvb.zstandard.ZstdCompressor(write_content_size=sized).compress(data)
                    pvb._encode = lambda codec, column: (pvb.ZSTD, 1, packed)
                    with pvb.create(path, [("x", "f32")], sync=False) as w:
                        w.append(x=np.zeros(1024))
                        w.commit()
                    with pvb.open(path) as f:
                        self.fails("does not decode to the size of its records", f.read, "x")
        finally:
            pvb._encode = original

    def test_what_is_no_path_vertex_buffer(self):
        self.fails("No such file", pvb.open, self.path("nowhere.pvb"))
        self.fails("not a regular file", pvb.open, self.folder)
        self.fails("not a regular file", pvb.open, "/dev/full")
        os.mkfifo(self.path("pipe"))
        self.fails("not a regular file", pvb.open, self.path("pipe"))
        for data in (b"", b"\x89PVB", b"v 0 0 0\n" * 1000, bytes(10000)):
            self.fails("is no path-vertex buffer", pvb.open, save(self.path("x"), data))
        data, _ = self.make()
        self.fails("its header cannot be read", pvb.open, save(self.path("x"), put(data, 9, b"??")))
        self.fails("holds no committed pass", pvb.open, save(self.path("x"), data[:12288]))
        with pvb.open(f"{SAMPLES}/golden-raw.pvb") as f:
            self.fails("has no channel colour; it has position", f.read, "colour")
            self.fails("but the file has 48", f.read, "pixel", 40, 9)
            self.fails("but the file has 2", f.pass_range, 2)

    def test_a_file_that_is_cut_while_open_is_an_error(self):
        data, _ = self.make()
        path = save(self.path("x.pvb"), data)
        with pvb.open(path) as f:
            os.truncate(path, len(data) // 2)
            self.fails("it was cut while being read", f.read, "g")


if __name__ == "__main__":
    sys.argv = [argument for argument in sys.argv if argument != "--long"]
    main()
