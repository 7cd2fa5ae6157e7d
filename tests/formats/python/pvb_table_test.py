#!/usr/bin/python3
"""pvb.py: tables come back by value and pass, and go on after a kill; what cannot be is refused."""
import re
import struct
import subprocess
import sys

from support import (CHANNELS, CODECS, FOLDER, ROOT, SAMPLES, bits, frames, load, main, mend, np, pvb, put, records_of,
                     save)
from table_support import CAPACITY, TABLES, UUID, TableTest, columns_of, count_of, make, write

import golden
import pvb_tool


class Values(TableTest):
    def test_tables_come_back_by_value_and_pass_and_passes_may_have_none(self):
        for codec in CODECS:
            path = self.path(codec)
            make(path, 9, codec)
            with pvb.open(path) as f:
                self.check(f, 9)
                self.assertEqual(f.version, (1, 1))
                table = f.tables["vertices"]
                self.assertEqual((table.name, table.chunk_capacity, table.passes), ("vertices", 20, 9))
                self.assertEqual(list(table.channels.values()), CHANNELS)
                self.assertEqual(table.pass_range(4), (90, 0))
                self.assertEqual(table.pass_range(8), (180, 0))
                self.assertEqual(bits(table.pass_index()), bits(np.repeat(
                    np.arange(9, dtype="<u4"), [count_of("vertices", k) for k in range(9)])))
                whole = table.read("c")
                for first, count in ((0, 1), (19, 2), (14, 60), (20, 20), (180, 0)):
                    self.assertEqual(bits(table.read("c", first, count)), bits(whole[first:first + count]))
                self.assertIn("a", table)
                self.assertNotIn("light", table)
                self.fails("table vertices: has no channel light; it has a, b", table.read, "light")
                self.fails("table vertices: 2 records from 179 on asked for, but the table has 180", table.read, "a",
                           179, 2)
                self.fails("pass 9 asked for, but the file has 9", table.pass_range, 9)

    def test_a_table_can_be_read_as_long_as_it_is_held(self):
        make(self.path("x.pvb"), 3)
        table = pvb.open(self.path("x.pvb")).tables["photons"]
        self.assertEqual(bits(table["light"]), bits(columns_of("photons", 2)["light"]))

    def test_without_tables_a_file_is_the_same_to_the_last_byte(self):
        path = self.path("x.pvb")
        pvb_tool.write_golden("raw", path)
        self.assertEqual(load(path), load(f"{SAMPLES}/golden-raw.pvb"))
        with pvb.open(path) as f:
            self.assertEqual((f.tables, f.version), ({}, (1, 0)))

    def test_the_summary_tells_the_tables(self):
        make(self.path("x.pvb"), 4)
        out = subprocess.run([sys.executable, f"{ROOT}/formats/pvb.py", self.path("x.pvb")], check=True,
                             stdout=subprocess.PIPE, universal_newlines=True).stdout
        self.assertIn("path-vertex buffer 1.1, closed\n", out)
        self.assertIn("\n  table vertices: 90 records, 6 chunks\n  a ", out)
        self.assertIn("\n  table photons: 12 records, 2 chunks\n  p                    f32 x 3\n  light ", out)

    def test_standard_tables_and_the_c_definitions_are_those_of_the_specification(self):
        with open(f"{ROOT}/formats/README.md") as spec, open(f"{ROOT}/formats/pvb.h") as header:
            text, definitions = spec.read(), header.read()
        defined = {m[0]: (m[1].lower(), int(m[2])) for m in re.findall(
            r'^#define PVB_\w+ \{"(\w+)", PVB_(\w+), (\d+), PVB_PLAIN\}', definitions, re.M)}
        seen = 0
        for table in ("vertices", "photons"):
            part = text[text.index(f"**`{table}`**"):]
            rows = re.findall(r"^\| `(\w+)` \| (\w+)(?: x (\d+))? \| (R?) ?\|", part[:part.index("\n\n", part.index(
                "|---"))], re.M)
            expected = [(name, kind, int(n or 1)) for name, kind, n, _ in rows]
            required = [name for name, _, _, mark in rows if mark]
            everything = pvb.standard_table(table, *(row[0] for row in rows))
            self.assertEqual([channel[:3] for channel in everything], expected)
            self.assertEqual([channel.name for channel in pvb.standard_table(table)], required)
            for name, kind, n in expected:
                self.assertEqual(defined[name], (kind, n), name)
                seen += 1
        self.assertEqual(seen, 28)
        small = pvb.standard_table("vertices", "normal", "outgoing", octahedral=["normal"], half=["emission"])
        self.assertIn(pvb.Channel("normal", "u16", 2, "octahedral"), small)
        self.assertIn(pvb.Channel("emission", "f16", 3), small)
        self.fails("there is no standard table light", pvb.standard_table, "light")
        self.fails("there is no standard channel camera", pvb.standard_table, "vertices", "camera")


class Commits(TableTest):
    def test_a_hundred_and_fifty_commits_open_through_the_index(self):
        path = self.path("x.pvb")
        data = make(path, 150)
        reads, original = [], pvb._File.frame
        pvb._File.frame = lambda self, *a: (reads.append(a), original(self, *a))[1]
        try:
            f = pvb.open(path)
        finally:
            pvb._File.frame = original
        self.assertLess(len(reads), 10)  # it is closed
        self.check(f, 150)
        f.close()
        chunks = [(0, 0, 0)]
        for number, (offset, length) in enumerate([f[1:] for f in frames(data) if f[0] == b"CMIT"], 1):
            base = 0 if number % 64 == 0 or number == 151 else number - 1
            totals = [struct.unpack_from("<QQ", data, offset + 64 + at) for at in (176, 208)]
            first = struct.unpack_from("<Q", data, offset + 64 + 56)[0], *(total[1] for total in totals)
            self.assertEqual(first, chunks[base])
            chunks.append((struct.unpack_from("<Q", data, offset + 64 + 24)[0], *(total[0] for total in totals)))
        self.assertEqual(len(chunks), 152)

    def test_indices_that_do_not_fit_take_a_later_base(self):
        path, most = self.path("x.pvb"), pvb.MAX_DIRECTORY
        pvb.MAX_DIRECTORY = 160 + 8 + 64 + 32 * 150
        try:
            data = make(path, 130)  # 282 chunks of tables
            with pvb.open(path) as f:
                self.check(f, 130)
            commits = [offset for kind, offset, _ in frames(data) if kind == b"CMIT"]
            bases = [struct.unpack_from("<Q", data, offset + 64 + 48)[0] for offset in commits]
            self.assertEqual(bases[63], 0)  # commit 64 has room for all, 128 and the closing one have not
            self.assertEqual((bases[127], bases[130]), (commits[126], commits[129]))
            w = pvb.resume(path, CHANNELS, sync=False, tables=TABLES)
            write(w, 130, 133)
            w.append(records_of(0, 20))
            for _ in range(151):
                w.append_to("photons", p=np.zeros((7, 3)), light=0)
            self.fails("more chunks in this pass than a commit can name; use larger chunks", w.commit)
            w.abort()
        finally:
            pvb.MAX_DIRECTORY = most
        with pvb.open(path) as f:
            self.check(f, 133)

    def test_a_resumed_file_is_the_same_as_one_written_at_once(self):
        for codec in CODECS:
            once = make(self.path("once"), 6, codec)
            w = pvb.create(self.path("twice"), CHANNELS, {"scene_hash": "s"}, codec, CAPACITY, False, UUID, TABLES)
            write(w, 0, 3)
            w.append(records_of(60, 20))
            w.append_to("photons", p=np.zeros((8, 3)), light=2)
            save(self.path("killed"), load(self.path("twice")))  # as it is on the disk now, with a tail
            w.abort()
            with pvb.resume(self.path("killed"), CHANNELS, codec=codec, sync=False, tables=TABLES) as w:
                self.assertEqual((w.resume_state, w.passes, list(w.tables)), (b"2", 3, list(TABLES)))
                write(w, 3, 6)
            self.assertEqual(load(self.path("killed")), once)

    def test_cut_at_every_page_a_file_ends_with_the_last_commit_and_goes_on(self):
        path = self.path("x.pvb")
        data, opened = make(path, 4), 0
        ends = [offset + length for kind, offset, length in frames(data) if kind == b"CMIT"][:4]
        for size in range(0, len(data), 4096):
            save(path, data[:size])
            passes = sum(end <= size for end in ends)
            if passes == 0:
                self.assertRaises(pvb.Error, pvb.open, path)
                continue
            opened += 1
            with pvb.open(path) as f:
                self.check(f, passes)
            with pvb.resume(path, CHANNELS, sync=False, tables=TABLES) as w:
                write(w, passes, 4)
            self.assertEqual(load(path)[8192:], data[8192:])
        self.assertGreater(opened, 10)


class Refusals(TableTest):
    def test_tables_that_cannot_be_are_refused(self):
        path, one = self.path("x.pvb"), [("x", "u8")]

        def create(tables, **more):
            pvb.create(path, one, tables=tables, **more)

        for text, tables in (("table paths: no table can have the name paths", {"paths": one}),
                             ("a table's name must be 1 to 56", {"": one}), ("a table's name must", {"a b": one}),
                             ("a table's name must be 1 to 56", {"a" * 57: one}),
                             ("table a: 1 to 256 channels", {"a": []}), ("table a: 1 to 256", {"a": one * 2}),
                             ("table a: channel x: unknown type i8", {"a": [("x", "i8")]}),
                             ("17 tables; at most 16", {f"t{k}": one for k in range(17)})):
            self.fails(text, create, tables)
        self.fails("table a: chunks of 0 records", create, {"a": one}, chunk_capacity={"a": 0})
        self.assertEqual(self.files(), [])
        with pvb.create(path, one, tables={f"t{k}": one for k in range(16)}) as w:
            w.append(x=[1])
            w.append_to("t15", x=[2, 3])
            w.commit()
        with pvb.open(path) as f:
            self.assertEqual([table.records for table in f.tables.values()], [0] * 15 + [2])

    def test_wrong_use_is_one_clear_line_and_sticks(self):
        for text, call in (
                ("has no table light; it has vertices, photons", lambda w: w.append_to("light", x=[1])),
                ("table photons: no values for channel light", lambda w: w.append_to("photons", p=np.zeros((1, 3)))),
                ("table photons: has no channel y", lambda w: w.append_to("photons", y=[1])),
                ("table photons: channel light: float64", lambda w: w.append_to("photons", p=np.zeros((1, 3)),
                                                                                light=[.5])),
                ("without records", lambda w: (w.append_to("photons", p=np.zeros((1, 3)), light=1), w.commit())),
                ("table photons: records were appended but not", lambda w: (
                    w.append_to("photons", p=np.zeros((1, 3)), light=1), w.close()))):
            w = pvb.create(self.path("x.pvb"), CHANNELS, None, "raw", CAPACITY, False, UUID, TABLES)
            write(w, 0, 3)
            self.fails(text, call, w)
            self.fails(text, w.commit)
            w.abort()
            with pvb.open(self.path("x.pvb")) as f:
                self.check(f, 3)

    def test_other_tables_are_not_resumed_and_the_file_is_unchanged(self):
        path = self.path("x.pvb")
        make(path, 3)
        before = load(path) + b"tail"
        save(path, before)
        photons = {"photons": TABLES["photons"]}
        for tables in (None, photons, {**photons, "vertices": CHANNELS}, {**TABLES, "more": CHANNELS},
                       {**TABLES, "vertices": CHANNELS[1:]}):
            self.fails("its tables are others", pvb.resume, path, CHANNELS, tables=tables)
        self.assertEqual(load(path), before)
        later = mend(put(load(path), 64 + 2, b"\x02"), 0)
        self.fails("written by version 1.2", pvb.resume, save(path, later), CHANNELS, tables=TABLES)
        self.assertEqual(load(path), later)


class Independent(TableTest):
    def test_the_reader_from_the_specification_says_the_same_of_the_golden_tables(self):
        path = self.path("x.pvb")
        pvb_tool.write_tables("raw", path, 5)
        outputs = [subprocess.run([sys.executable, *command, path], check=True, stdout=subprocess.PIPE).stdout
                   for command in ([f"{FOLDER}/../read_pvb.py"], [f"{FOLDER}/pvb_tool.py", "dump"])]
        self.assertEqual(*outputs)
        self.assertEqual(outputs[0].count(b"\n"), 2 * len(golden.CHANNELS) + 2 + 2)


if __name__ == "__main__":
    main()
