// Versions: what may be ignored is ignored, what must be understood is refused by name.
#include <filesystem>

#include "catch.h"
#include "core/error.h"
#include "file_bytes.h"
#include "formats/check/check.h"
#include "formats/check/recover.h"
#include "formats/read/reader.h"
#include "formats/write/concatenate.h"
#include "golden.h"
#include "golden_versions.h"

using namespace psf;
using namespace psf::formats;

namespace {

constexpr std::size_t kMajorAt = 64, kMinorAt = 66, kRequiredAt = 68, kOptionalAt = 72;

// The file with a field of HEAD changed, and the copies in the commits with it.
test::Bytes with_head_field(const test::Bytes& whole, std::size_t at, std::size_t size,
                            std::uint64_t value) {
  test::Bytes bytes = whole;
  test::put(bytes, at, size, value);
  test::mend(bytes, 0);
  for (const auto& commit : test::frames(bytes, "CMIT")) {
    const std::size_t place = commit.offset + test::get(bytes, commit.offset + 160, 8);
    const std::size_t length = test::get(bytes, commit.offset + 168, 8);
    std::copy_n(bytes.begin(), length, bytes.begin() + static_cast<std::ptrdiff_t>(place));
    test::put(bytes, commit.offset + 176, 4,
              test::slow_crc(std::span(bytes).subspan(place, length)));
    test::mend(bytes, commit.offset);
  }
  return bytes;
}

std::string refusal(const std::string& path) {
  try {
    const Reader reader(path);
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::bad_input);
    CHECK_THROWS_AS(check(path), Error);
    return error.what();
  }
  return "";
}

// Puts a frame of type "NEWF" behind the golden file's second commit, and a tail commit is left
// out.
test::Bytes with_new_frame(const test::Bytes& whole, std::uint32_t flags) {
  const auto commits = test::frames(whole, "CMIT");
  const auto& last = commits.back();
  test::Bytes bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(last.offset));
  test::Bytes fresh(whole.begin() + static_cast<std::ptrdiff_t>(last.offset),
                    whole.begin() + static_cast<std::ptrdiff_t>(last.offset) + 4096);
  const test::Bytes closing(whole.begin() + static_cast<std::ptrdiff_t>(last.offset), whole.end());
  const std::string type = "NEWF";
  for (std::size_t k = 0; k < 4; ++k) fresh[24 + k] = static_cast<std::byte>(type[k]);
  test::put(fresh, 28, 4, flags);
  test::put(fresh, 40, 8, 4096);
  bytes.insert(bytes.end(), fresh.begin(), fresh.end());
  test::mend(bytes, last.offset);
  // The closing commit moves behind it.
  const std::size_t place = bytes.size();
  bytes.insert(bytes.end(), closing.begin(), closing.end());
  test::put(bytes, place + 32, 8, place);
  test::put(bytes, place + 48, 8, test::get(closing, 48, 8) + 1);
  test::mend(bytes, place);
  const std::size_t slot = test::frames(whole, "SLOT").at(0).offset;
  test::put(bytes, slot + 1024, 8, place);
  test::put(bytes, slot + 1024 + 16, 8, test::get(closing, 48, 8) + 1);
  test::mend_slot(bytes, slot + 1024);
  return bytes;
}

}  // namespace

TEST_CASE("unknown minor versions and optional bits are read, and kept") {
  const test::Scratch scratch;
  const std::string path = scratch.path("v.pvb");
  test::write_golden(path, Codec::raw);
  const test::Bytes whole = test::load(path);
  test::save(path, with_head_field(whole, kMinorAt, 2, 7));
  CHECK(Reader(path).head().minor == 7);
  CHECK(check(path).faults.empty());
  test::save(path, with_head_field(whole, kOptionalAt, 4, 0x80000001));
  CHECK(Reader(path).head().optional_features == 0x80000001);
  CHECK(check(path).faults.empty());
}

TEST_CASE("unknown major versions and required bits are refused, saying which version wrote it") {
  const test::Scratch scratch;
  const std::string path = scratch.path("v.pvb");
  test::write_golden(path, Codec::raw);
  const test::Bytes whole = test::load(path);
  test::save(path, with_head_field(whole, kMajorAt, 2, 2));
  CHECK(refusal(path).find("version 2.0") != std::string::npos);
  test::save(path, with_head_field(whole, kRequiredAt, 4, 4));
  CHECK(refusal(path).find("version 1.0") != std::string::npos);
  CHECK(refusal(path).find("0x4") != std::string::npos);
}

TEST_CASE("bytes of a swapped host are refused") {
  const test::Scratch scratch;
  const std::string path = scratch.path("v.pvb");
  test::write_golden(path, Codec::raw);
  const test::Bytes whole = test::load(path);
  test::save(path, with_head_field(whole, kMajorAt, 2, 0x0100));
  CHECK(refusal(path).find("version 256.0") != std::string::npos);
}

TEST_CASE("frames of other types are skipped, or refused where they must be understood") {
  const test::Scratch scratch;
  const std::string path = scratch.path("v.pvb");
  test::write_golden(path, Codec::raw);
  const test::Bytes whole = test::load(path);
  test::save(path, with_new_frame(whole, 0));
  const Reader reader(path);
  CHECK(reader.records() == test::kGoldenRecords);
  CHECK(reader.closed());
  CHECK(check(path).faults.empty());

  test::Bytes required = with_new_frame(whole, 1);
  const auto commit = test::frames(required, "CMIT").back();
  test::put(required, commit.offset + 64 + 64, 8, 1);  // the commit counts it
  test::mend(required, commit.offset);
  test::save(path, required);
  CHECK(refusal(path).find("version 1.0") != std::string::npos);
  // Met on the way when there is no hint.
  required.at(test::frames(required, "SLOT").at(0).offset) ^= std::byte{1};
  test::save(path, required);
  CHECK(refusal(path).find("NEWF") != std::string::npos);
}

namespace {

const std::string kData = PSF_SOURCE_DIR "/sample_data/";

void check_example(const Reader& reader) {
  REQUIRE(reader.records() == 3);
  CHECK(reader.closed());
  std::array<float, 9> position{};
  reader.read_floats(0, 0, 3, position);
  CHECK(position == std::array<float, 9>{1, 2, 3, 0.5f, -0.5f, 0.25f, 0, 0, 0});
  test::Bytes flags(3);
  reader.read(1, 0, 3, flags);
  CHECK(flags == test::Bytes{std::byte{3}, std::byte{1}, std::byte{0}});
}

void check_later(const Head& head) {
  CHECK(head.minor == 1);
  CHECK(head.optional_features == 0x80000001u);
  CHECK(head.metadata == R"({"producer":"later","later.key":{"deep":[1,2]}})");
  CHECK(std::string(reinterpret_cast<const char*>(head.later_bytes.data()),
                    head.later_bytes.size()) == "bytes of version 1.1");
}

}  // namespace

TEST_CASE("the golden file of a later minor version is read, and copied with all it declares") {
  const test::Scratch scratch;
  const std::string minor = kData + "golden-minor.pvb";
  check_example(Reader(minor));
  check_later(Reader(minor).head());
  CHECK(check(minor).faults.empty());
  CHECK(recover(minor, scratch.path("a.pvb")).nothing_lost());
  static_cast<void>(concatenate(std::vector{minor}, scratch.path("b.pvb")));
  // Its header lost: the copy has all of it too.
  test::Bytes bytes = test::load(minor);
  bytes.at(70) ^= std::byte{1};
  test::save(scratch.path("torn.pvb"), bytes);
  CHECK(recover(scratch.path("torn.pvb"), scratch.path("c.pvb")).head_restored);
  for (const char* name : {"a.pvb", "b.pvb", "c.pvb"}) {
    check_example(Reader(scratch.path(name)));
    check_later(Reader(scratch.path(name)).head());
  }
}

TEST_CASE("golden files that this version cannot read are refused, saying which wrote them") {
  const test::Scratch scratch;
  CHECK(refusal(kData + "golden-major.pvb").find("written by version 2.0") != std::string::npos);
  const std::string required = refusal(kData + "golden-required.pvb");
  CHECK(required.find("written by version 1.0") != std::string::npos);
  CHECK(required.find("bits 0x4") != std::string::npos);
  CHECK(refusal(kData + "golden-swapped.pvb").find("header cannot be read") != std::string::npos);
  for (const std::string name : {"golden-major.pvb", "golden-required.pvb", "golden-swapped.pvb"}) {
    const std::string copy = scratch.path("copy.pvb"), out = scratch.path("out.pvb");
    const test::Bytes whole = test::load(kData + name);
    test::save(copy, whole);
    CHECK_THROWS_AS(recover(copy, out), Error);
    CHECK_THROWS_AS(concatenate(std::vector{copy}, out), Error);
    CHECK_THROWS_AS(Writer::resume(copy, Reader(kData + "golden-minor.pvb").head()), Error);
    CHECK(test::load(copy) == whole);
    CHECK_FALSE(std::filesystem::exists(out));
    CHECK_FALSE(std::filesystem::exists(out + ".partial"));
  }
}

TEST_CASE("the golden files of other versions are made again byte for byte") {
  const test::Scratch scratch;
  const std::string path = scratch.path("v.pvb");
  const auto same = [&](const char* name) {
    const test::Bytes golden = test::load(kData + name);
    return test::load(path) == golden && golden.size() < 25'000;
  };
  test::write_golden_minor(path);
  CHECK(same("golden-minor.pvb"));
  test::write_golden_major(path);
  CHECK(same("golden-major.pvb"));
  test::write_golden_required(path);
  CHECK(same("golden-required.pvb"));
  test::write_golden_swapped(path);
  CHECK(same("golden-swapped.pvb"));
}
