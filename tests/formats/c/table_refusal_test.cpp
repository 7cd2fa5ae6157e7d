// Tables through the C header: what is refused, by which text, and that the file stays as it was.
#include <filesystem>

#include "catch.h"
#include "golden.h"
#include "table_file.h"

using namespace psf;
using test::Bytes;
using test::CFile;

namespace {

// Tables and channels that may be wrong: the error of making a file with them.
std::string create_tables_error(const std::vector<pvb_table>& tables) {
  const test::Scratch scratch;
  const pvb_channel path = PVB_PIXEL;
  const std::string name = scratch.path("x.pvb");
  const CFile file(
      pvb_create_with(name.c_str(), &path, 1, tables.data(), tables.size(), "{}", nullptr));
  if (!file.error().empty()) {
    CHECK_FALSE(std::filesystem::exists(name + ".partial"));
    CHECK(file.error().find('\n') == std::string::npos);
  }
  return file.error();
}

std::string resume_tables_error(const std::string& path, const std::vector<pvb_table>& tables) {
  const formats::Head head = test::golden_head();
  const auto channels = test::c_channels(head);
  return CFile(pvb_resume_with(path.c_str(), channels.data(), channels.size(), tables.data(),
                               tables.size(), head.metadata.c_str(), nullptr))
      .error();
}

}  // namespace

TEST_CASE("tables that cannot be are refused before anything is written") {
  const pvb_channel vertex = PVB_PATH, wide = {"wide", PVB_F64, 16, PVB_PLAIN};
  const pvb_channel two[] = {PVB_PATH, PVB_PATH};
  const std::string longest(56, 'a'), longer(57, 'a');
  CHECK(create_tables_error({{longest.c_str(), &vertex, 1, 0}}).empty());
  CHECK(create_tables_error({{longer.c_str(), &vertex, 1, 0}}).find("table 0") !=
        std::string::npos);
  CHECK(create_tables_error({{nullptr, &vertex, 1, 0}}).find("table 0") != std::string::npos);
  CHECK(create_tables_error({{"a b", &vertex, 1, 0}}).find("printable") != std::string::npos);
  CHECK(create_tables_error({{"paths", &vertex, 1, 0}}).find("the name paths") !=
        std::string::npos);
  CHECK(create_tables_error({{"a", &vertex, 1, 0}, {"a", &vertex, 1, 0}})
            .find("table a is declared twice") != std::string::npos);
  CHECK(create_tables_error({{"a", nullptr, 1, 0}}).find("table a: no channels") !=
        std::string::npos);
  CHECK(create_tables_error({{"a", &vertex, 0, 0}}).find("table a: no channels") !=
        std::string::npos);
  CHECK(create_tables_error({{"a", two, 2, 0}}).find("table a: channel path") != std::string::npos);
  CHECK(create_tables_error({{"a", &vertex, 1, (1u << 24) + 1}}).find("table a: chunks") !=
        std::string::npos);
  CHECK(create_tables_error({{"a", &wide, 1, (1u << 23) + 1}}).find("at most 1 GiB") !=
        std::string::npos);
  std::vector<std::string> names;
  for (int k = 0; k < 17; ++k) names.push_back("t" + std::to_string(k));
  std::vector<pvb_table> many;
  for (const std::string& name : names) many.push_back({name.c_str(), &vertex, 1, 100});
  CHECK(create_tables_error(many).find("more than 16 tables") != std::string::npos);
  many.pop_back();
  CHECK(create_tables_error(many).empty());
}

TEST_CASE("a wrong call on a table is an error that sticks, and the last commit stays") {
  const test::Scratch scratch;
  const std::string path = scratch.path("m.pvb");
  const auto wrong = [&](const std::string& text, const auto& call) {
    {
      const CFile file(test::create_tables(path));
      for (std::size_t pass = 0; pass < 3; ++pass) test::write_tables_pass(file.get(), pass);
      CHECK(call(file.get()) == PVB_USAGE);
      CHECK(file.error().find(text) != std::string::npos);
      CHECK(test::write_tables_pass(file.get(), 3) == PVB_USAGE);
    }
    CHECK(test::table_faults(path, 3) == "");
  };
  const pvb_array none[2] = {{nullptr, 0}, {nullptr, 0}};
  wrong("no such table; it has 2", [&](pvb_file* f) { return pvb_append_to(f, 2, 0, none); });
  wrong("no such table", [&](pvb_file* f) { return pvb_append_to(f, SIZE_MAX, 1, none); });
  wrong("table photons: no arrays", [](pvb_file* f) { return pvb_append_to(f, 1, 1, nullptr); });
  wrong("table photons: no values are given for channel flags",
        [&](pvb_file* f) { return pvb_append_to(f, 1, 1, none); });
  wrong("without records", [](pvb_file* f) {  // of the paths
    const Bytes value(8);
    const pvb_array arrays[] = {{value.data(), 0}, {value.data(), 0}};
    CHECK(pvb_append_to(f, 1, 20, arrays) == 0);
    return pvb_commit(f, nullptr, 0);
  });
  wrong("table photons: records were appended but not", [](pvb_file* f) {
    const Bytes value(8);
    const pvb_array arrays[] = {{value.data(), 0}, {value.data(), 0}};
    CHECK(pvb_append_to(f, 1, 7, arrays) == 0);
    return pvb_close(f);
  });
  const CFile file(pvb_open(path.c_str()));
  std::uint64_t first = 0, count = 0;
  Bytes out(8);
  CHECK(pvb_read_from(file.get(), 2, 0, 0, 0, nullptr, 0) == PVB_USAGE);
  CHECK(pvb_read_from(file.get(), SIZE_MAX, 0, 0, 1, out.data(), 8) == PVB_USAGE);
  CHECK(pvb_read_from(file.get(), 1, 2, 0, 1, out.data(), 8) == PVB_USAGE);
  CHECK(pvb_read_from(file.get(), 1, 1, 10, 1, out.data(), 8) == PVB_USAGE);
  CHECK(file.error().find("table photons: holds 10 records") != std::string::npos);
  CHECK(pvb_read_from(file.get(), 1, 1, 0, 2, out.data(), 7) == PVB_USAGE);
  CHECK(pvb_pass_of(file.get(), 0, 3, &first, &count) == PVB_USAGE);
  CHECK(pvb_pass_of(file.get(), 2, 0, &first, &count) == PVB_USAGE);
  CHECK(pvb_read_from(file.get(), 1, 1, 9, 1, out.data(), 8) == 0);
  CHECK(file.error().empty());
  CHECK(pvb_append_to(nullptr, 0, 0, nullptr) == PVB_LIMIT);
}

TEST_CASE("other tables are not resumed, and the file stays as it was") {
  const test::Scratch scratch;
  const std::string path = scratch.path("u.pvb");
  test::write_tables(path, 3);
  const Bytes whole = test::load(path);
  const auto channels = test::table_channels();
  const auto tables = test::c_tables(channels);
  auto other = tables;
  other.pop_back();
  CHECK(resume_tables_error(path, other).find("table 1 (photons) is not the same") !=
        std::string::npos);
  CHECK(resume_tables_error(path, {}).find("table 0 (vertices)") != std::string::npos);
  other = tables;
  other.push_back(other[0]);
  CHECK(resume_tables_error(path, other).find("table 2 (none)") != std::string::npos);
  other = tables;
  std::swap(other[0], other[1]);
  CHECK(resume_tables_error(path, other).find("table 0 (vertices)") != std::string::npos);
  other = tables;
  --other[1].channel_count;
  CHECK(resume_tables_error(path, other).find("table photons: channel 1") != std::string::npos);
  CHECK((test::load(path) == whole));
  CHECK(CFile(test::resume_golden(path)).error().find("table 0 (vertices)") != std::string::npos);
  other = tables;
  other[0].chunk_capacity = 3;  // stays that of the file
  CHECK(resume_tables_error(path, other).empty());
  CHECK(test::table_faults(path, 3) == "");
}
