#!/usr/bin/python3
"""pvb.py: values and bytes that it reads and writes, resuming, locks."""
import os
import re
import subprocess
import sys
import threading
import uuid

from support import (CHANNELS, CODECS, FOLDER, HAS_ZSTD, ROOT, SAMPLES, Test, bits, frames, load, main, np, pvb,
                     records_of, save)

import golden
import pvb_tool


class Reading(Test):
    def test_golden_files_give_every_expected_value(self):
        for name in ("raw", "tail") + (("zstd",) if HAS_ZSTD else ()):
            with self.subTest(name), pvb.open(f"{SAMPLES}/golden-{name}.pvb") as f:
                self.assertEqual((f.records, f.passes, f.version), (48, 2, (1, 0)))
                self.assertEqual(f.closed, name != "tail")
                self.assertEqual(f.uncommitted_bytes > 0, name == "tail")
                self.assertEqual(str(f.uuid), golden.UUID)
                self.assertEqual([tuple(c) for c in f.channels.values()], golden.CHANNELS)
                self.assertEqual([c["name"] for c in f.metadata["cameras"]], ["main", "left", "right"])
                self.assertEqual(f.resume_state, b"resume 1")
                self.assertEqual([f.pass_range(k) for k in range(2)], [(0, 24), (24, 24)])
                self.assertEqual(bits(f.pass_index()), bits(np.repeat(np.arange(2, dtype="<u4"), 24)))
                for k, (channel, _, components, _) in enumerate(golden.CHANNELS):
                    stored = f.read(channel, codes=True)
                    self.assertEqual(stored.shape, (48, components) if components > 1 else (48,))
                    self.assertEqual(bits(stored), golden.values(k), channel)
                    for first, count in ((0, 1), (15, 2), (47, 1), (5, 40), (16, 16), (48, 0)):
                        part = f.read(channel, first, count, codes=True)
                        self.assertEqual(bits(part), golden.values(k, first, count))

    def test_octahedral_values_are_unit_vectors_and_marks(self):
        codes = np.array([[32767, 32767], [32767, 0], [0, 32767], [65534, 32767], [65535, 65535], [65535, 0],
                          [0, 65535], [0, 0]], "<u2")
        vectors = pvb.decode_octahedral(codes)
        self.assertEqual(vectors.dtype, np.float32)
        expected = np.array([[0, 0, 1], [0, -1, 0], [-1, 0, 0], [1, 0, 0], [0, 0, 0], [np.nan] * 3, [np.nan] * 3,
                             [0, 0, -1]], np.float32)
        np.testing.assert_array_equal(np.abs(vectors), np.abs(expected))
        np.testing.assert_array_equal(vectors, expected)
        rng = np.random.default_rng(1)
        unit = rng.normal(size=(100000, 3))
        unit /= np.linalg.norm(unit, axis=1, keepdims=True)
        back = pvb.decode_octahedral(pvb.encode_octahedral(unit)).astype(float)
        self.assertLess(np.degrees(np.linalg.norm(back - unit, axis=1).max()), 0.004)
        marks = pvb.encode_octahedral(np.array([[0, 0, 0], [np.nan, 0, 0], [0, np.inf, 0]]))
        self.assertEqual(marks.tolist(), [[65535, 65535], [65535, 0], [65535, 0]])

    def test_arrays_are_the_callers_own(self):
        with pvb.open(f"{SAMPLES}/golden-raw.pvb") as f:
            part = f.read("distance", 3, 4)
            part[:] = 7
            self.assertEqual(bits(f.read("distance", 3, 4)), golden.values(6, 3, 4))

    def test_several_threads_read_one_file(self):
        with pvb.open(f"{SAMPLES}/golden-raw.pvb") as f:
            wrong = []

            def read():
                for first in range(40):
                    if bits(f.read("position", first, 7)) != golden.values(0, first, 7):
                        wrong.append(first)

            threads = [threading.Thread(target=read) for _ in range(4)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual(wrong, [])

    def test_the_summary_names_every_channel(self):
        out = subprocess.run([sys.executable, f"{ROOT}/formats/pvb.py", f"{SAMPLES}/golden-raw.pvb"], check=True,
                             stdout=subprocess.PIPE, universal_newlines=True).stdout
        self.assertIn("48 in 2 passes, 4 chunks", out)
        for channel in golden.CHANNELS:
            self.assertIn(f"  {channel[0]} ", out)

    def test_without_zstandard_only_zstd_columns_are_missing(self):
        script = ("import sys; sys.modules['zstandard'] = None; sys.dont_write_bytecode = True\n"
                  f"sys.path.insert(0, {ROOT + '/formats'!r}); import pvb\n"
                  f"f = pvb.open({SAMPLES + '/golden-zstd.pvb'!r}); assert f.records == 48\n"
                  "read = 0\n"
                  "for name in f.channels:\n"
                  "    try: f[name]; read += 1\n"
                  "    except pvb.Error as error: message = error\n"
                  "assert 0 < read < len(f.channels); print(message)\n"
                  f"try: pvb.create({self.path('x.pvb')!r}, f.channels.values(), codec='zstd')\n"
                  "except pvb.Error as error: print(error)\n")
        out = subprocess.run([sys.executable, "-c", script], check=True, stdout=subprocess.PIPE,
                             universal_newlines=True).stdout.splitlines()
        self.assertEqual(len(out), 2)
        for line in out:
            self.assertIn("python3-zstandard", line)
            self.assertIn("psf cat --codec raw IN -o OUT", line)
        self.assertEqual(self.files(), [])


class Writing(Test):
    def test_the_raw_golden_files_are_made_again_byte_for_byte(self):
        pvb_tool.write_golden("raw", self.path("raw.pvb"))
        self.assertEqual(load(self.path("raw.pvb")), load(f"{SAMPLES}/golden-raw.pvb"))

    def test_the_example_of_the_specification_is_what_is_written(self):
        path = self.path("example.pvb")
        with pvb.create(path, [("position", "f32", 3), ("flags", "u8")], {"producer": "example"},
                        uuid=uuid.UUID(bytes=bytes(range(0xA0, 0xB0)))) as w:
            w.append(position=[[1, 2, 3], [0.5, -0.5, 0.25], [0, 0, 0]], flags=[3, 1, 0])
            w.commit(b"next")
        data, expected, rows = load(path), bytearray(0x5000), 0
        with open(f"{ROOT}/formats/README.md") as spec:
            for line in spec:
                row = re.match(r"    ([0-9a-f]{8})  ((?:[0-9a-f]{2} ){16}) ", line)
                if row:
                    place = int(row.group(1), 16)
                    expected[place:place + 16] = bytes.fromhex(row.group(2))
                    rows += 1
        self.assertGreater(rows, 20)
        self.assertEqual(data, bytes(expected))

    def test_what_is_written_is_read_bit_for_bit(self):
        for codec in CODECS:
            with self.subTest(codec):
                path = self.path(codec)
                parts = [[1], [99, 1], [100, 250, 3], [700]]  # records of each append, by pass
                expected = {channel.name: b"" for channel in CHANNELS}
                first = 0
                with pvb.create(path, CHANNELS, {"unit": "\u00e4"}, codec, 100, sync=False) as w:
                    for appends in parts:
                        for count in appends:
                            columns = records_of(first, count)
                            w.append(columns)
                            first += count
                            for name, column in columns.items():
                                expected[name] += bits(column)
                                column[:] = 0  # it is ours again
                        w.commit()
                with pvb.open(path) as f:
                    self.assertEqual(f.metadata, {"unit": "\u00e4"})
                    self.assertEqual(f.records, first)
                    self.assertEqual([f.pass_range(k)[1] for k in range(4)], [sum(p) for p in parts])
                    self.assertLessEqual(int(f.chunks["count"].max()), 100)
                    for name in f.channels:
                        self.assertEqual(bits(f.read(name, codes=True)), expected[name], name)
                    used = {c[0] for k in range(len(f.chunks)) for c in f._chunk_columns(k)}
                    self.assertEqual(used, {pvb.RAW} if codec == "raw" else {pvb.RAW, pvb.ZSTD})

    def test_values_are_converted_where_nothing_is_lost(self):
        channels = pvb.standard_channels("flags", "normal", "reflectance", octahedral=["normal"], half=["reflectance"])
        self.assertEqual([c.name for c in channels], ["position", "throughput", "contribution", "distance", "pixel",
                                                      "flags", "normal", "reflectance"])
        path = self.path("x.pvb")
        with pvb.create(path, channels) as w:
            w.append(position=np.ones((4, 3)), throughput=1, contribution=0.5, distance=[1, 2, 3, 4],
                     pixel=np.arange(4), flags=3, normal=np.tile([0.0, 0, 1], (4, 1)), reflectance=0.25)
            w.commit()
        with pvb.open(path) as f:
            self.assertEqual(f["pixel"].tolist(), [0, 1, 2, 3])
            self.assertEqual(f["flags"].tolist(), [3] * 4)
            self.assertEqual(f["contribution"].tolist(), [[0.5] * 3] * 4)
            self.assertEqual(f["normal"].tolist(), [[0, 0, 1]] * 4)
            self.assertEqual(f["reflectance"].dtype, np.float16)

    def test_wrong_use_is_one_clear_line_and_sticks(self):
        channels = [("x", "f32", 3), ("id", "u8")]
        x = np.zeros((2, 3), np.float32)
        for text, columns in (("no values for channel id", {"x": x}),
                              ("has no channel y; it has x, id", {"x": x, "id": 1, "y": 2}),
                              ("they must be equal", {"x": x, "id": [1, 2, 3]}),
                              ("expected (2, 3) values, got (2, 2)", {"x": x[:, :2], "id": 1}),
                              ("u8 holds 0 to 255", {"x": x, "id": [1, 256]}),
                              ("u8 holds 0 to 255", {"x": x, "id": [1, -1]}),
                              ("float64 cannot be stored as u8", {"x": x, "id": [1.5, 2]})):
            with self.subTest(text):
                w = pvb.create(self.path("x.pvb"), channels)
                self.fails(text, w.append, columns)
                self.fails(text, w.commit)
                w.abort()
                self.assertEqual(self.files(), [])
        for text, more in (("unknown codec lz4", {"codec": "lz4"}), ("cannot be stored as JSON", {"metadata": "{"}),
                           ("must be a JSON object", {"metadata": "[]"}), ("a chunk has", {"chunk_capacity": 0}),
                           ("cannot be stored as JSON", {"metadata": {"a": float("nan")}})):
            self.fails(text, pvb.create, self.path("x.pvb"), channels, **more)
        self.fails("unknown type f8", pvb.create, self.path("x.pvb"), [("x", "f8", 1)])
        self.fails("of different names", pvb.create, self.path("x.pvb"), [("x", "f32"), ("x", "f32")])
        self.fails("not the name of a regular file", pvb.create, "/dev/full", channels)
        self.fails("No such file", pvb.create, self.path("nowhere/x.pvb"), channels)
        self.fails("there is no standard channel colour", pvb.standard_channels, "colour")
        self.assertEqual(self.files(), [])

    def test_the_name_appears_with_the_first_commit_and_an_exception_keeps_the_last(self):
        path = self.path("x.pvb")
        with self.assertRaises(ZeroDivisionError):
            with pvb.create(path, CHANNELS) as w:
                w.append(records_of(0, 10))
                self.assertEqual(self.files(), ["x.pvb.partial"])
                raise ZeroDivisionError
        self.assertEqual(self.files(), [])
        with self.assertRaises(ZeroDivisionError):
            with pvb.create(path, CHANNELS, chunk_capacity=4) as w:
                w.append(records_of(0, 10))
                w.commit()
                self.assertEqual(self.files(), ["x.pvb"])
                w.append(records_of(10, 10))
                raise ZeroDivisionError
        with pvb.open(path) as f:
            self.assertEqual((f.records, f.closed, f.uncommitted_bytes), (10, False, 0))
        before = load(path)
        with self.assertRaises(pvb.Error):  # nothing is committed: the old file stays
            with pvb.create(path, CHANNELS) as w:
                w.append(records_of(0, 1))
        self.assertEqual(load(path), before)
        self.assertEqual(self.files(), ["x.pvb"])

    def test_a_reader_sees_what_is_committed_while_the_file_grows(self):
        path = self.path("x.pvb")
        with pvb.create(path, CHANNELS, chunk_capacity=16) as w:
            for k in range(5):
                w.append(records_of(20 * k, 20))
                w.commit()
                with pvb.open(path) as f:
                    self.assertEqual((f.records, f.passes, f.closed), (20 * k + 20, k + 1, False))
                    self.assertEqual(bits(f.read("f", 20 * k)), bits(records_of(20 * k, 20)["f"]))

    def test_five_thousand_commits_open_through_the_index(self):
        path, n = self.path("x.pvb"), 5000
        with pvb.create(path, [("x", "u32")], sync=False) as w:
            for k in range(n):
                w.append(x=[k])
                w.commit()
            reads = []
            original = pvb._File.frame
            pvb._File.frame = lambda self, *a: (reads.append(a), original(self, *a))[1]
            try:
                f = pvb.open(path)
            finally:
                pvb._File.frame = original
            self.assertLess(len(reads), 128)
            self.assertEqual(bits(f["x"]), bits(np.arange(n, dtype="<u4")))
            f.close()
        # By the chain that resume() builds on, too.
        with pvb.resume(path, [("x", "u32")]) as w:
            w.append(x=[n])
            w.commit()
        with pvb.open(path) as f:
            self.assertEqual(f.passes, n + 1)
            self.assertEqual(bits(f["x"]), bits(np.arange(n + 1, dtype="<u4")))


class Resuming(Test):
    def write(self, w, first, last):
        for k in range(first, last):
            w.append(records_of(50 * k, 50))
            w.commit(b"%d" % k)

    def test_a_resumed_file_is_the_same_as_one_written_at_once(self):
        own = uuid.uuid4()
        for codec in CODECS:
            once, twice = self.path("once"), self.path("twice")
            with pvb.create(once, CHANNELS, {"scene_hash": "s"}, codec, 16, uuid=own) as w:
                self.write(w, 0, 6)
            w = pvb.create(twice, CHANNELS, {"scene_hash": "s"}, codec, 16, uuid=own)
            self.write(w, 0, 3)
            w.append(records_of(150, 40))
            save(self.path("killed"), load(twice))  # as it is on the disk now, with a tail
            w.abort()
            with pvb.resume(self.path("killed"), CHANNELS, {"scene_hash": "s"}, codec) as w:
                self.assertEqual((w.resume_state, w.records, w.passes), (b"2", 150, 3))
                self.write(w, 3, 6)
            self.assertEqual(load(self.path("killed")), load(once))
            # A closed one goes on too, and resuming alone changes nothing.
            pvb.resume(once, CHANNELS, codec=codec).close()
            self.assertEqual(load(self.path("killed")), load(once))
            with pvb.resume(once, CHANNELS, codec=codec) as w:
                self.write(w, 6, 7)
            with pvb.open(once) as f:
                self.assertEqual((f.passes, f.closed), (7, True))
                expected = b"".join(bits(records_of(50 * k, 50)["g"]) for k in range(7))
                self.assertEqual(bits(f["g"]), expected)

    def test_another_schema_or_scene_is_refused_and_the_file_unchanged(self):
        path = self.path("x.pvb")
        with pvb.create(path, CHANNELS, {"scene_hash": "s"}) as w:
            self.write(w, 0, 2)
        save(path, load(path) + b"tail")
        before = load(path)
        self.fails("its channels are others", pvb.resume, path, CHANNELS[:-1], {"scene_hash": "s"})
        self.fails("its channels are others", pvb.resume, path, CHANNELS[::-1], {"scene_hash": "s"})
        self.fails("is of another scene", pvb.resume, path, CHANNELS, {"scene_hash": "t"})
        self.fails("is of another scene", pvb.resume, path, CHANNELS, {})
        self.fails("no such file", pvb.resume, self.path("y.pvb"), CHANNELS)
        self.assertEqual(load(path), before)
        self.assertEqual(self.files(), ["x.pvb"])

    def test_a_resumed_file_whose_index_was_damaged_carries_the_whole_one(self):
        path = self.path("x.pvb")
        w = pvb.create(path, CHANNELS, chunk_capacity=16)
        self.write(w, 0, 4)
        w.abort()
        data = load(path)
        commit = [offset for kind, offset, _ in frames(data) if kind == b"CMIT"][1]
        save(path, data[:commit] + b"?" + data[commit + 1:])
        with pvb.open(path) as f:
            self.assertTrue(f._scanned)
        w = pvb.resume(path, CHANNELS)
        self.write(w, 4, 6)
        w.abort()
        with pvb.open(path) as f:
            self.assertFalse(f._scanned)
            self.assertEqual(bits(f["c"]), b"".join(bits(records_of(50 * k, 50)["c"]) for k in range(6)))

    def test_two_writers_are_refused(self):
        path = self.path("x.pvb")
        refused = "another process is writing it"
        with pvb.create(path, CHANNELS) as w:
            self.fails(refused, pvb.create, path, CHANNELS)  # still x.pvb.partial
            self.write(w, 0, 1)
            self.fails(refused, pvb.create, path, CHANNELS)
            self.fails(refused, pvb.resume, path, CHANNELS)
            other = subprocess.run([sys.executable, os.path.join(FOLDER, "pvb_tool.py"), "golden", "raw", path],
                                   stderr=subprocess.PIPE, universal_newlines=True)
            self.assertEqual(other.returncode, 1)
            self.assertIn(refused, other.stderr)
            self.write(w, 1, 2)
        self.assertEqual(self.files(), ["x.pvb"])
        with pvb.open(path) as f:
            self.assertEqual((f.passes, f.closed), (2, True))
        with pvb.create(path, CHANNELS) as new:  # over an old one: locked until it is replaced
            self.fails(refused, pvb.resume, path, CHANNELS)
            self.write(new, 0, 1)
        with pvb.open(path) as f:
            self.assertEqual(f.passes, 1)

    def test_a_lock_counts_only_on_the_file_that_has_the_name(self):
        path = self.path("x.pvb")
        with pvb.create(path, CHANNELS) as w:
            self.write(w, 0, 1)
        saved = load(path)
        flock, calls = pvb.fcntl.flock, []

        def replaced_meanwhile(descriptor, operation):  # as by another writer between open and lock
            if not calls:
                os.rename(path, self.path("old.pvb"))
                save(path, saved)
            calls.append(operation)
            flock(descriptor, operation)

        pvb.fcntl.flock = replaced_meanwhile
        try:
            w = pvb.resume(path, CHANNELS)
        finally:
            pvb.fcntl.flock = flock
        self.write(w, 1, 2)
        w.abort()
        self.assertEqual(len(calls), 2)
        self.assertEqual(load(self.path("old.pvb")), saved)
        with pvb.open(path) as f:
            self.assertEqual(f.passes, 2)

    def test_a_commit_is_flushed_between_its_chunks_and_the_slot(self):
        log, pwritev, fdatasync = [], os.pwritev, os.fdatasync

        def write(descriptor, views, offset):
            log.append("slot" if offset % 4096 else bytes(views[0][24:28]).decode())
            return pwritev(descriptor, views, offset)

        os.pwritev, os.fdatasync = write, lambda descriptor: (log.append("sync"), fdatasync(descriptor))
        try:
            with pvb.create(self.path("x.pvb"), CHANNELS, chunk_capacity=30) as w:
                self.write(w, 0, 1)
        finally:
            os.pwritev, os.fdatasync = pwritev, fdatasync
        commit = ["sync", "CMIT", "sync", "slot"]
        self.assertEqual(log, ["HEAD", "SLOT", "CHNK", "CHNK", *commit, *commit])

    def test_a_full_disk_leaves_the_last_commit(self):
        import resource
        path = self.path("x.pvb")
        channels = [("x", "f64", 16)]
        w = pvb.create(path, channels)
        w.append(x=np.zeros((10, 16)))
        w.commit()
        size = os.path.getsize(path)
        old = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size + 8192, old[1]))
        try:
            w.append(x=np.zeros((1000, 16)))
            self.fails("cannot write", w.commit)
            self.fails("cannot write", w.append, x=np.zeros((1, 16)))
            self.fails("cannot write", w.close)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, old)
        with pvb.open(path) as f:
            self.assertEqual((f.records, f.closed), (10, False))
        w.abort()
        self.assertEqual(os.path.getsize(path), size)


if __name__ == "__main__":
    main()
