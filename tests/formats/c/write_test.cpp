// What the C header writes is, byte for byte, what the C++ writer writes, and what the spec shows.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "c_file.h"
#include "catch.h"
#include "formats/check/check.h"
#include "formats/read/reader.h"
#include "golden.h"

namespace fs = std::filesystem;
using namespace psf;
using test::CFile;

namespace {

const std::string kData = PSF_SOURCE_DIR "/sample_data/";
const pvb_channel kNumber = {"n", PVB_U32, 1, PVB_PLAIN};
const pvb_options kUnsynced = {4, 1, nullptr};

int append_numbers(pvb_file* file, std::uint32_t first, std::uint32_t count) {
  std::vector<std::uint32_t> values(count);
  for (std::uint32_t k = 0; k < count; ++k) values[k] = first + k;
  const pvb_array array = {values.data(), 4};
  return pvb_append(file, count, &array);
}

}  // namespace

TEST_CASE("the golden files come out byte for byte, in all types and encodings") {
  const test::Scratch scratch;
  const std::string path = scratch.path("g.pvb");
  {
    const CFile file(test::create_golden(path));
    REQUIRE(file.error().empty());
    CHECK(test::write_golden_pass(file.get(), 0) == 0);
    CHECK(test::write_golden_pass(file.get(), 1) == 0);
    CHECK(test::append_golden(file.get(), test::kGoldenRecords, test::kGoldenCapacity) == 0);
    CHECK(test::load(path) == test::load(kData + "golden-tail.pvb"));
  }
  CHECK(test::golden_faults(path, test::kGoldenRecords) == "");
  {
    const CFile file(test::create_golden(path));
    test::write_golden_pass(file.get(), 0);
    test::write_golden_pass(file.get(), 1);
    CHECK(pvb_close(file.get()) == 0);
    CHECK(file.error().empty());
    CHECK(file.info().records == test::kGoldenRecords);
  }
  CHECK(test::load(path) == test::load(kData + "golden-raw.pvb"));
}

TEST_CASE("the example of the spec comes out row by row") {
  const test::Scratch scratch;
  const std::string path = scratch.path("example.pvb");
  std::array<unsigned char, 16> uuid{};
  for (std::size_t k = 0; k < uuid.size(); ++k) uuid[k] = static_cast<unsigned char>(0xA0 + k);
  const std::array<pvb_channel, 2> channels = {{PVB_POSITION, PVB_FLAGS}};
  const pvb_options options = {0, 1, uuid.data()};
  const std::array<float, 9> position = {1, 2, 3, 0.5f, -0.5f, 0.25f, 0, 0, 0};
  const std::array<std::uint8_t, 3> flags = {3, 1, 0};
  const std::array<pvb_array, 2> arrays = {{{position.data(), 12}, {flags.data(), 1}}};
  const CFile file(
      pvb_create(path.c_str(), channels.data(), 2, R"({"producer":"example"})", &options));
  pvb_append(file.get(), 3, arrays.data());
  pvb_commit(file.get(), "next", 4);
  REQUIRE(pvb_close(file.get()) == 0);

  std::ifstream in(PSF_SOURCE_DIR "/formats/README.md");
  const std::string spec((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  std::istringstream rows(test::hex_dump(path));
  std::size_t place = 0, count = 0;
  for (std::string row; std::getline(rows, row); ++count) {
    CAPTURE(row);
    place = spec.find(row, place);
    REQUIRE(place != std::string::npos);
  }
  CHECK(count > 20);
}

TEST_CASE("arrays of structs, in any sizes across chunks, give the same file") {
  struct Record {
    char odd;  // what follows is not aligned
    std::array<unsigned char, 12> position;
    unsigned char flags;
  };
  static_assert(sizeof(Record) == 14);
  std::vector<Record> records(1000);
  for (std::size_t k = 0; k < records.size(); ++k) {
    const std::array<float, 3> value = {static_cast<float>(k), -1, 0.5f};
    std::memcpy(records[k].position.data(), value.data(), 12);
    records[k].flags = static_cast<unsigned char>(k % 4);
  }
  const std::uint16_t camera = 7;
  const std::array<pvb_channel, 3> channels = {{PVB_POSITION, PVB_FLAGS, PVB_CAMERA}};
  const test::Scratch scratch;
  const std::string path = scratch.path("s.pvb");
  std::vector<test::Bytes> files;
  for (const std::size_t step : std::vector<std::size_t>{1000, 1, 7, 16, 17, 333}) {
    const pvb_options options = {16, 1, reinterpret_cast<const unsigned char*>("0123456789abcdef")};
    const CFile file(pvb_create(path.c_str(), channels.data(), 3, "{}", &options));
    for (std::size_t first = 0; first < records.size(); first += step) {
      Record* r = &records[first];
      const pvb_array arrays[] = {PVB_FIELD(r, position), PVB_FIELD(r, flags), {&camera, 0}};
      pvb_append(file.get(), std::min(step, records.size() - first), arrays);
    }
    pvb_append(file.get(), 0, nullptr);
    pvb_commit(file.get(), nullptr, 0);
    REQUIRE(pvb_close(file.get()) == 0);
    files.push_back(test::load(path));
    CHECK(files.back() == files.front());
  }
  CHECK(formats::check(path).faults.empty());
  const formats::Reader reader(path);
  REQUIRE(reader.records() == records.size());
  const test::Bytes position = test::read_all(reader, 0), flags = test::read_all(reader, 1),
                    cameras = test::read_all(reader, 2);
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < records.size(); ++k) {
    std::array<float, 3> value{};
    std::memcpy(value.data(), &position[12 * k], 12);
    wrong += value != std::array<float, 3>{static_cast<float>(k), -1, 0.5f};
    wrong += std::to_integer<std::size_t>(flags[k]) != k % 4 || test::get(cameras, 2 * k, 2) != 7;
  }
  CHECK(wrong == 0);
}

TEST_CASE("thousands of commits: both readers follow the index, and it stays small") {
  const test::Scratch scratch;
  const std::string path = scratch.path("many.pvb");
  constexpr std::uint32_t kCommits = 5000;
  const CFile file(pvb_create(path.c_str(), &kNumber, 1, "{}", &kUnsynced));
  for (std::uint32_t k = 1; k <= kCommits; ++k) {
    append_numbers(file.get(), 4 * (k - 1), 4);
    pvb_commit(file.get(), nullptr, 0);
    if (k % 997 == 0 || k % 4096 <= 1 || (k % 64 <= 1 && k > 4900) || k < 4) {
      const formats::Reader reader(path);
      const CFile read(pvb_open(path.c_str()));
      const auto first = static_cast<std::uint32_t>(4 * (k - 1));
      std::uint32_t value = 0;
      CHECK(pvb_read(read.get(), 0, first + 3, 1, &value, 4) == 0);
      if (reader.records() != 4 * k || read.info().passes != k || value != first + 3) FAIL(k);
    }
  }
  CHECK(file.error().empty());
  CHECK(formats::check(path).faults.empty());
  CHECK(fs::file_size(path) < kCommits * (2 * 4096 + 64 * 32));
  // Commit k has chunks up to k, and begins its index as the rule of the C++ writer has it.
  const test::Bytes bytes = test::load(path);
  std::uint64_t k = 0, wrong = 0;
  for (const auto& commit : test::frames(bytes, "CMIT")) {
    ++k;
    const std::uint64_t first = k % 4096 == 0 ? 0 : k % 64 == 0 ? k / 4096 * 4096 : k - 1;
    wrong += test::get(bytes, commit.offset + 64 + 56, 8) != first;
  }
  CHECK(k == kCommits);
  CHECK(wrong == 0);
}

TEST_CASE("what breaks a limit is refused before anything is written") {
  const test::Scratch scratch;
  const std::string path = scratch.path("l.pvb");
  const auto refused = [&](std::vector<pvb_channel> channels, const std::string& metadata = "{}",
                           std::uint32_t capacity = 4) {
    const pvb_options options = {capacity, 1, nullptr};
    const CFile file(
        pvb_create(path.c_str(), channels.data(), channels.size(), metadata.c_str(), &options));
    CHECK(file.error().find('\n') == std::string::npos);
    const bool clean = !fs::exists(path + ".partial") && !fs::exists(path);
    return file.error().find("l.pvb: ") != std::string::npos && clean;
  };
  const std::string longest(56, 'a'), longer(57, 'a');
  CHECK(refused({}));
  CHECK(refused({kNumber, kNumber}));
  CHECK(refused({{"", PVB_U8, 1, 0}}));
  CHECK(refused({{nullptr, PVB_U8, 1, 0}}));
  CHECK(refused({{"a b", PVB_U8, 1, 0}}));
  CHECK(refused({{"\xC3\xA4", PVB_U8, 1, 0}}));
  CHECK(refused({{longer.c_str(), PVB_U8, 1, 0}}));
  CHECK_FALSE(refused({{longest.c_str(), PVB_U8, 1, 0}}));
  CHECK(refused({{"c", PVB_U8, 0, 0}}));
  CHECK(refused({{"c", PVB_U8, 17, 0}}));
  CHECK(refused({{"c", 0, 1, 0}}));
  CHECK(refused({{"c", 8, 1, 0}}));
  CHECK(refused({{"c", PVB_U8, 1, 2}}));
  CHECK(refused({{"c", PVB_U8, 2, PVB_OCTAHEDRAL}}));
  CHECK(refused({kNumber}, "{}", (1u << 24) + 1));
  CHECK(refused({{"wide", PVB_F64, 16, 0}}, "{}", (1u << 23) + 1));
  CHECK(refused({kNumber}, "[1]"));
  CHECK(refused({kNumber}, "{"));
  CHECK(refused({kNumber}, "{\"a\":\"" + std::string(1 << 20, 'x') + "\"}"));
  std::vector<std::string> names;
  for (int k = 0; k < 257; ++k) names.push_back("c" + std::to_string(k));
  std::vector<pvb_channel> many;
  for (int k = 0; k < 256; ++k)
    many.push_back({names[static_cast<std::size_t>(k)].c_str(), 1, 1, 0});
  CHECK_FALSE(refused(many));
  many.push_back({names[256].c_str(), 1, 1, 0});
  CHECK(refused(many));
}

TEST_CASE("a name that is taken or cannot be is refused, and its file left alone") {
  const test::Scratch scratch;
  const std::string path = scratch.path("t.pvb");
  const auto error = [](const std::string& name) {
    return CFile(pvb_create(name.c_str(), &kNumber, 1, "{}", &kUnsynced)).error();
  };
  CHECK(error(scratch.path("none/t.pvb")).find("check the name") != std::string::npos);
  CHECK_FALSE(error("").empty());
  CHECK_FALSE(error(scratch.path("")).empty());
  CHECK(error("/dev/null").find("regular file") != std::string::npos);
  for (const std::string& name : {path, path + ".partial"}) {
    test::save(name, test::Bytes(10));
    const int lock = ::open(name.c_str(), O_RDONLY);
    REQUIRE(::flock(lock, LOCK_EX) == 0);
    CHECK(error(path).find("another process is writing it") != std::string::npos);
    CHECK(test::load(name) == test::Bytes(10));
    ::close(lock);
    CHECK(error(path).empty());
    CHECK_FALSE(fs::exists(path + ".partial"));
  }
  CHECK(test::load(path) == test::Bytes(10));
  const CFile writer(pvb_create(path.c_str(), &kNumber, 1, "{}", &kUnsynced));
  CHECK(error(path).find("another process") != std::string::npos);
  append_numbers(writer.get(), 0, 3);
  CHECK(pvb_commit(writer.get(), nullptr, 0) == 0);
  CHECK(error(path).find("another process") != std::string::npos);
  CHECK(formats::Reader(path).records() == 3);
}

TEST_CASE("misuse is an error that sticks; the last commit stays") {
  const test::Scratch scratch;
  const std::string path = scratch.path("m.pvb");
  const auto wrong = [&](const std::string& text, const auto& call) {
    {
      const CFile file(pvb_create(path.c_str(), &kNumber, 1, "{}", &kUnsynced));
      append_numbers(file.get(), 0, 6);
      pvb_commit(file.get(), nullptr, 0);
      CHECK(call(file.get()) != 0);
      const std::string first = file.error();
      CHECK(first.find(text) != std::string::npos);
      CHECK(append_numbers(file.get(), 6, 1) != 0);
      CHECK(pvb_commit(file.get(), nullptr, 0) != 0);
      CHECK(pvb_close(file.get()) != 0);
      CHECK(file.error() == first);
    }
    CHECK(formats::Reader(path).records() == 6);
    CHECK(formats::check(path).uncommitted_bytes == 0);
  };
  wrong("without records", [](pvb_file* f) { return pvb_commit(f, nullptr, 0); });
  wrong("no arrays", [](pvb_file* f) { return pvb_append(f, 1, nullptr); });
  wrong("channel n", [](pvb_file* f) {
    const pvb_array none = {nullptr, 4};
    return pvb_append(f, 1, &none);
  });
  wrong("not committed", [](pvb_file* f) {
    append_numbers(f, 6, 9);
    return pvb_close(f);
  });
  wrong("65536 fit", [](pvb_file* f) {
    append_numbers(f, 6, 1);
    return pvb_commit(f, test::Bytes(65537).data(), 65537);
  });
  wrong("writing only", [](pvb_file* f) { return pvb_read(f, 0, 0, 1, &f, 4); });
  wrong("closed already", [](pvb_file* f) {
    CHECK(pvb_close(f) == 0);
    return pvb_close(f);
  });
  CHECK(pvb_append(nullptr, 0, nullptr) == PVB_LIMIT);
  CHECK(std::string(pvb_error(nullptr)) == "out of memory");
  CHECK(pvb_about(nullptr)->records == 0);
}
