// Every integer field at its extremes, its checksum made right again: an error or a limit, with
// little memory.
#include <sys/resource.h>

#include <cstdio>
#include <ctime>

#include "catch.h"
#include "core/error.h"
#include "failing.h"
#include "file_bytes.h"
#include "formats/check/check.h"
#include "formats/check/recover.h"
#include "formats/read/reader.h"
#include "golden.h"

using namespace psf;
using namespace psf::formats;

namespace {

struct Field {
  std::size_t offset, size;
};

constexpr std::uint64_t kValues[] = {0,
                                     1,
                                     2,
                                     63,
                                     4096,
                                     65536,
                                     0x7FFFFFFF,
                                     0x80000000,
                                     0xFFFFFFFF,
                                     0x100000000,
                                     0x7FFFFFFFFFFFFFFF,
                                     0x8000000000000000,
                                     0xFFFFFFFFFFFFF000,
                                     0xFFFFFFFFFFFFFFFF};

std::vector<Field> fields_of(const test::FramePlace& frame, const test::Bytes& bytes) {
  std::vector<Field> fields = {{24, 4}, {28, 4}, {32, 8}, {40, 8}, {48, 8}, {56, 4}};
  const std::size_t directory = test::get(bytes, frame.offset + 56, 4);
  const auto add = [&](std::size_t offset, std::initializer_list<std::size_t> sizes) {
    for (const std::size_t size : sizes) {
      fields.push_back({offset, size});
      offset += size;
    }
  };
  if (frame.type == "HEAD") {
    add(64, {2, 2, 4, 4, 4, 4, 4});
    for (std::size_t k = 0; k < 19; ++k) add(128 + 64 * k + 56, {1, 1, 1});
    add(128, {1, 8});
  } else if (frame.type == "CHNK") {
    add(64, {8, 4, 4, 4});
    for (std::size_t place = 96; place + 24 <= 64 + directory; place += 24) {
      add(place, {2, 1, 1, 4, 8, 8});
    }
  } else if (frame.type == "CMIT") {
    add(64, {4, 4, 8, 8, 8, 8, 8, 8, 8, 8});
    for (std::size_t place : {136u, 160u, 184u}) add(place, {8, 8, 4});
    for (std::size_t entry = 0; entry < 4; ++entry) add(256 + 32 * entry, {8, 8, 8, 4, 4});
  }
  return fields;
}

long peak_kilobytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

// Opens, reads and checks: an error is as good as an answer, all else is not.
void use(const std::string& path) {
  try {
    static_cast<void>(check(path));
  } catch (const Error&) {
  }
  try {
    const Reader reader(path);
    for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
      const std::uint64_t count = std::min<std::uint64_t>(reader.records(), 64);
      test::Bytes out(count * reader.head().channels[k].stride());
      try {
        reader.read(k, 0, count, out);
      } catch (const Error&) {
      }
    }
    static_cast<void>(reader.resume_state());
  } catch (const Error&) {
  }
}

// The same of recover(); of a file whose fault costs nothing, `all_recovered`, no error.
void use_recovered(const std::string& path, bool all_recovered) {
  const std::string out = path + ".out";
  std::remove(out.c_str());
  try {
    const RecoverResult report = recover(path, out);
    if (!check(out).faults.empty()) FAIL("a fault in what was recovered");
    if (Reader(out).records() != report.records_saved) FAIL("the report counts otherwise");
    if (report.records_saved > test::kGoldenRecords) FAIL("records that never were");
  } catch (const Error& error) {
    if (all_recovered) FAIL(error.what());
  }
}

// The section index of a commit has its own checksum, at 64 + 72 + 16.
void mend_index(test::Bytes& bytes, std::size_t frame) {
  const std::uint64_t offset = test::get(bytes, frame + 136, 8);
  const std::uint64_t length = test::get(bytes, frame + 144, 8);
  if (offset > bytes.size() - frame || length > bytes.size() - frame - offset) return;
  test::put(bytes, frame + 152, 4,
            test::slow_crc(std::span(bytes).subspan(frame + offset, length)));
}

}  // namespace

namespace {

struct Cost {
  double seconds = 0;            // processor time
  std::uint64_t bytes_read = 0;  // from the file
};

// Opening, checking, reading and recovering a golden file of 36 KiB reads each part a few times.
constexpr std::uint64_t kMostRead = std::uint64_t{1} << 20;

// Recovers one in so many. The most that a file cost.
Cost try_fields(std::size_t recover_each) {
  const test::WithoutSync fast;
  const test::Scratch scratch;
  const std::string path = scratch.path("field.pvb");
  [[maybe_unused]] const long before = peak_kilobytes();
  Cost most;
  std::size_t files = 0;
  for (const Codec codec : {Codec::raw, Codec::zstd}) {
    test::write_golden(path, codec);
    const test::Bytes whole = test::load(path);
    auto frames = test::frames(whole);
    // The first of each kind, and the last commit.
    const auto last = frames.back();
    frames.resize(3);
    frames.push_back(last);
    const std::size_t slot = frames[1].offset;
    for (const auto& frame : frames) {
      for (const Field& field : fields_of(frame, whole)) {
        for (const std::uint64_t value : kValues) {
          if (field.size < 8 && value >> (8 * field.size) != 0) continue;
          test::Bytes bytes = whole;
          test::put(bytes, frame.offset + field.offset, field.size, value);
          if (frame.type == "CMIT" && field.offset >= 256) mend_index(bytes, frame.offset);
          test::mend(bytes, frame.offset);
          test::save(path, bytes);
          const std::clock_t start = std::clock();
          const std::uint64_t bytes_before = test::calls().bytes_read;
          use(path);
          if (files % recover_each == 0) use_recovered(path, false);
          most.seconds =
              std::max(most.seconds, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
          most.bytes_read = std::max(most.bytes_read, test::calls().bytes_read - bytes_before);
          ++files;
        }
      }
    }
    for (std::size_t record : {1024u, 2048u}) {
      for (std::size_t field : {0u, 8u, 16u}) {
        for (const std::uint64_t value : kValues) {
          test::Bytes bytes = whole;
          test::put(bytes, slot + record + field, 8, value);
          test::mend_slot(bytes, slot + record);
          test::save(path, bytes);
          use(path);
          if (files % recover_each == 0) use_recovered(path, true);  // a hint can only be wrong
          ++files;
        }
      }
    }
  }
  CAPTURE(files);
  CHECK(files > 2000);
#ifndef __SANITIZE_ADDRESS__  // it keeps what was freed for a while
  CHECK(peak_kilobytes() - before < 300 * 1024);
#endif
  return most;
}

}  // namespace

TEST_CASE(
    "every integer field at its extremes is an error or harmless, with little reading and memory") {
  CHECK(try_fields(5).bytes_read < kMostRead);
}

TEST_CASE("every integer field at its extremes is an error or harmless to recover", "[.][long]") {
  const Cost most = try_fields(1);
  CHECK(most.bytes_read < kMostRead);
  CHECK(most.seconds < 1);
}
