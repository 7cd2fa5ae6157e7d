// Tables through the C header: they come back by value and pass, and go on after a kill.
#include <algorithm>
#include <array>
#include <cstring>

#include "catch.h"
#include "golden.h"
#include "table_file.h"

using namespace psf;
using test::Bytes;
using test::CFile;

namespace {

// As a program of version 1.0 copies it: commits end at 160.
Bytes copied_by_1_0(Bytes bytes) {
  for (const auto& commit : test::frames(bytes, "CMIT")) {
    test::put(bytes, commit.offset + 56, 4, 160);
    test::mend(bytes, commit.offset);
  }
  return bytes;
}

}  // namespace

TEST_CASE("tables come back by value and pass, of every type, and passes may have none") {
  const test::Scratch scratch;
  const std::string path = scratch.path("t.pvb");
  for (const std::size_t passes : {std::size_t{1}, std::size_t{2}, std::size_t{9}}) {
    test::write_tables(path, passes);
    CHECK(test::table_faults(path, passes) == "");
  }
  const CFile file(pvb_open(path.c_str()));
  CHECK(test::get(test::load(path), 66, 2) == 1);  // minor version, optional features
  CHECK(test::get(test::load(path), 72, 4) == 2);
  const auto expected = test::table_channels();
  for (std::size_t t = 0; t < expected.size(); ++t) {
    const pvb_table_info& table = file.info().tables[t];
    CHECK(table.name == test::golden_tables()[t].name);
    CHECK(table.chunk_capacity == test::golden_tables()[t].capacity);
    CHECK(pvb_find_table(file.get(), table.name) == static_cast<int>(t));
    REQUIRE(table.channel_count == expected[t].size());
    for (std::size_t k = 0; k < expected[t].size(); ++k) {
      CHECK(std::strcmp(table.channels[k].name, expected[t][k].name) == 0);
      CHECK(table.channels[k].type == expected[t][k].type);
      CHECK(table.channels[k].components == expected[t][k].components);
      CHECK(table.channels[k].encoding == expected[t][k].encoding);
      CHECK(pvb_find_in(file.get(), t, expected[t][k].name) == static_cast<int>(k));
    }
  }
  CHECK(pvb_find_table(file.get(), "paths") == -1);
  CHECK(pvb_find_in(file.get(), 1, "position") == -1);
  CHECK(pvb_find_in(file.get(), 2, "position") == -1);
}

TEST_CASE("without tables a file is the same to the last byte, whichever way it is made") {
  const test::Scratch scratch;
  const std::string path = scratch.path("n.pvb");
  const formats::Head head = test::golden_head();
  const formats::Uuid uuid = test::golden_uuid();
  const pvb_options options = {test::kGoldenCapacity, 1, uuid.data()};
  const auto channels = test::c_channels(head);
  const CFile file(pvb_create_with(path.c_str(), channels.data(), channels.size(), nullptr, 0,
                                   head.metadata.c_str(), &options));
  for (std::size_t pass = 0; pass < 2; ++pass) test::write_golden_pass(file.get(), pass);
  CHECK(pvb_close(file.get()) == 0);
  CHECK((test::load(path) == test::load(PSF_SOURCE_DIR "/sample_data/golden-raw.pvb")));
}

TEST_CASE("tables are told by the optional feature, whatever the minor version") {
  const test::Scratch scratch;
  const std::string path = scratch.path("v.pvb");
  test::write_tables(path, 3);
  const auto changed = [&](std::uint64_t minor, std::uint64_t features) {
    Bytes bytes = test::load(path);
    test::put(bytes, 66, 2, minor);
    test::put(bytes, 72, 4, features);
    test::mend(bytes, 0);
    test::save(path, bytes);
  };
  for (const std::uint64_t minor : {0u, 1u, 7u}) {
    changed(minor, 0x80000003u);
    CHECK(test::table_faults(path, 3) == "");
    changed(minor, 0x80000001u);
    const CFile file(pvb_open(path.c_str()));
    CHECK(file.error().empty());
    CHECK(file.info().table_count == 0);
    CHECK((test::c_read(file.get(), 0, 0, 72) == test::golden_values(0, 0, 72)));
  }
  for (const std::uint64_t features : {std::uint64_t{3}, std::uint64_t{0x80000002u}}) {
    changed(1, features);
    CHECK(CFile(test::resume_tables(path)).error().find("newer pvb.h") != std::string::npos);
  }
  changed(2, 2);
  CHECK(CFile(test::resume_tables(path)).error().find("newer pvb.h") != std::string::npos);
  changed(1, 2);
  CHECK(CFile(test::resume_tables(path)).error().empty());
  const CFile later(pvb_open(PSF_SOURCE_DIR "/sample_data/golden-minor.pvb"));
  CHECK(later.error().empty());
  CHECK(later.info().table_count == 0);
}

TEST_CASE("records of tables and of paths in any order and any portions give the same values") {
  const test::Scratch scratch;
  const std::string path = scratch.path("p.pvb");
  const pvb_channel channel = PVB_PIXEL, vertex = PVB_PATH;
  const pvb_table tables[] = {{"a", &vertex, 1, 5}, {"b", &vertex, 1, 3}};
  const pvb_options options = {4, 1, nullptr};
  {
    const CFile file(pvb_create_with(path.c_str(), &channel, 1, tables, 2, "{}", &options));
    std::uint32_t next[3] = {0, 100, 200};
    for (std::uint32_t k = 0; k < 90; ++k) {
      const std::uint32_t which = k * 7 % 3, count = k % 5;
      std::uint32_t values[5];
      for (std::uint32_t& value : values) value = next[which]++;
      next[which] -= 5 - count;
      const pvb_array array = {values, 4};
      if (which == 0) pvb_append(file.get(), count, &array);
      if (which > 0) pvb_append_to(file.get(), which - 1, count, &array);
      if (k % 30 == 29) pvb_commit(file.get(), nullptr, 0);
    }
    REQUIRE(pvb_close(file.get()) == 0);
  }
  const CFile file(pvb_open(path.c_str()));
  CHECK(file.info().records + file.info().tables[0].records + file.info().tables[1].records == 180);
  for (std::size_t t = 0; t < 2; ++t) {
    std::vector<std::uint32_t> values(file.info().tables[t].records);
    CHECK(pvb_read_from(file.get(), t, 0, 0, values.size(), values.data(), 4) == 0);
    std::size_t wrong = 0;
    for (std::size_t k = 0; k < values.size(); ++k) wrong += values[k] != 100 * (t + 1) + k;
    CHECK(values.size() > 40);
    CHECK(wrong == 0);
  }
}

TEST_CASE("killed after each pass and resumed, tables go on, over two steps of the index") {
  const test::Scratch scratch;
  const std::string path = scratch.path("r.pvb");
  constexpr std::size_t kPasses = 140;
  for (std::size_t pass = 0; pass < kPasses; ++pass) {
    {
      const CFile file(pass == 0 ? test::create_tables(path) : test::resume_tables(path));
      REQUIRE(file.error().empty());
      CHECK(file.info().tables[0].records == test::records_before(0, pass));
      REQUIRE(test::write_tables_pass(file.get(), pass) == 0);
      if (pass % 3 == 1) CHECK(pvb_close(file.get()) == 0);
      if (pass % 3 == 2) test::append_tables(file.get(), 7);  // never committed
    }
    if (pass % 20 == 19) REQUIRE(test::table_faults(path, pass + 1) == "");
  }
  CHECK(test::table_faults(path, kPasses) == "");
}

TEST_CASE("a commit's base is that of all its indices, by the rule of the paths") {
  const test::Scratch scratch;
  const std::string path = scratch.path("b.pvb");
  test::write_tables(path, 200);
  REQUIRE(test::table_faults(path, 200) == "");
  const Bytes bytes = test::load(path);
  std::vector<std::array<std::uint64_t, 3>> chunks(1);  // by commit, of the paths and the tables
  std::uint64_t number = 0, wrong = 0;
  for (const auto& commit : test::frames(bytes, "CMIT")) {
    const std::size_t at = commit.offset + 64;
    ++number;
    const std::uint64_t from = number % 64 == 0 || number == 201 ? 0 : number - 1;
    chunks.push_back({test::get(bytes, at + 24, 8), test::get(bytes, at + 176, 8),
                      test::get(bytes, at + 208, 8)});
    wrong += test::get(bytes, at + 56, 8) != chunks[from][0];
    wrong += test::get(bytes, at + 184, 8) != chunks[from][1];
    wrong += test::get(bytes, at + 216, 8) != chunks[from][2];
    const std::uint64_t entries =
        chunks.back()[1] - chunks[from][1] + chunks.back()[2] - chunks[from][2];
    wrong += test::get(bytes, commit.offset + 56, 4) != 160 + 8 + 2 * 32 + 32 * entries;
  }
  CHECK(number == 201);
  CHECK(wrong == 0);
}

TEST_CASE("cut at every page, tables end with the last commit before the cut, and go on there") {
  const test::Scratch scratch;
  const std::string path = scratch.path("c.pvb");
  test::write_tables(path, 5);
  const Bytes whole = test::load(path);
  const auto commits = test::frames(whole, "CMIT");
  std::size_t opened = 0;
  for (std::size_t size = 0; size < whole.size(); size += 4096) {
    test::save(path, std::span(whole).first(size));
    std::size_t passes = 0;
    for (std::size_t k = 0; k < 5; ++k) passes += commits[k].offset + commits[k].length <= size;
    const std::string faults = test::table_faults(path, passes);
    if (passes == 0) {
      CHECK_FALSE(faults.empty());
      continue;
    }
    REQUIRE(faults == "");
    ++opened;
    const CFile file(test::resume_tables(path));
    for (std::size_t pass = passes; pass < 5; ++pass) test::write_tables_pass(file.get(), pass);
    REQUIRE(pvb_close(file.get()) == 0);
    // All but SLOT is the same as without a stop.
    const Bytes now = test::load(path);
    const auto behind = [](const Bytes& b) {
      return std::span(b).subspan(test::frames(b)[2].offset);
    };
    REQUIRE(std::ranges::equal(behind(now), behind(whole)));
    REQUIRE(test::table_faults(path, 5) == "");
  }
  CHECK(opened > 10);
}

TEST_CASE("of a file that a program of version 1.0 copied, all tables are empty, and may go on") {
  const test::Scratch scratch;
  const std::string path = scratch.path("o.pvb");
  test::write_tables(path, 3, false);
  test::save(path, copied_by_1_0(test::load(path)));
  {
    const CFile file(pvb_open(path.c_str()));
    REQUIRE(file.error().empty());
    CHECK(file.info().records == 3 * test::kGoldenPass);
    REQUIRE(file.info().table_count == 2);
    for (std::size_t t = 0; t < 2; ++t) {
      std::uint64_t first = 1, count = 1;
      CHECK(file.info().tables[t].records == 0);
      CHECK(pvb_pass_of(file.get(), t, 2, &first, &count) == 0);
      CHECK((first == 0 && count == 0));
    }
  }
  const Bytes value = test::table_values(0, 0, 0, 1);
  {
    const CFile file(test::resume_tables(path));
    test::append_golden(file.get(), 3 * test::kGoldenPass, test::kGoldenPass);
    std::vector<Bytes> columns;
    std::vector<pvb_array> of_vertex;
    for (std::size_t k = 0; k < 19; ++k) columns.push_back(test::table_values(0, k, 0, 1));
    for (const Bytes& column : columns) of_vertex.push_back({column.data(), 0});
    pvb_append_to(file.get(), 0, 1, of_vertex.data());
    pvb_commit(file.get(), nullptr, 0);
    REQUIRE(pvb_close(file.get()) == 0);
  }
  const CFile file(pvb_open(path.c_str()));
  std::uint64_t first = 1, count = 0;
  CHECK(pvb_pass_of(file.get(), 0, 3, &first, &count) == 0);
  CHECK((first == 0 && count == 1));
  CHECK((test::c_read_from(file.get(), 0, 0, 0, 1) == value));
}

TEST_CASE("indices that do not fit into a directory take a later base, or are refused",
          "[.][long]") {
  const test::Scratch scratch;
  const std::string path = scratch.path("l.pvb");  // two gigabytes, and not for long
  const pvb_channel channel = {"x", PVB_U32, 1, PVB_PLAIN};
  const pvb_table table = {"t", &channel, 1, 1};
  const pvb_options options = {0, 1, nullptr};
  constexpr std::uint32_t kMost = ((16u << 20) - 160 - 8 - 32) / 32;  // chunks of a directory
  const auto append = [](pvb_file* file, std::uint32_t first, std::uint32_t count) {
    std::vector<std::uint32_t> values(count);
    for (std::uint32_t k = 0; k < count; ++k) values[k] = first + k;
    const pvb_array array = {values.data(), 4};
    pvb_append(file, 1, &array);
    pvb_append_to(file, 0, count, &array);
    return pvb_commit(file, nullptr, 0);
  };
  {
    const CFile file(pvb_create_with(path.c_str(), &channel, 1, &table, 1, "{}", &options));
    CHECK(append(file.get(), 0, kMost + 1) == PVB_LIMIT);
    CHECK(file.error().find("more chunks in this pass than a commit can name") !=
          std::string::npos);
  }
  {
    const CFile file(pvb_create_with(path.c_str(), &channel, 1, &table, 1, "{}", &options));
    CHECK(append(file.get(), 0, kMost) == 0);
    CHECK(append(file.get(), kMost, 10) == 0);
    REQUIRE(pvb_close(file.get()) == 0);
  }
  const CFile file(pvb_open(path.c_str()));
  REQUIRE(file.error() == "");
  REQUIRE(file.info().tables[0].records == kMost + 10);
  std::size_t wrong = 0;
  for (const std::uint32_t k : {0u, 1u, kMost / 2, kMost - 1, kMost, kMost + 9}) {
    std::uint32_t value = ~k;
    wrong += pvb_read_from(file.get(), 0, 0, k, 1, &value, 4) != 0 || value != k;
  }
  CHECK(wrong == 0);
}
