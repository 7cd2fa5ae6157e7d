// Versions: what may be ignored is ignored, what must be understood is refused by name.
#include "catch.h"
#include "file_bytes.h"
#include "formats/check.h"
#include "formats/error.h"
#include "formats/reader.h"
#include "golden.h"

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
