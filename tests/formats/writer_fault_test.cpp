// Failing writes: whichever system call fails, the error sticks and the last commit is readable.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "catch.h"
#include "file_bytes.h"
#include "formats/check.h"
#include "formats/error.h"
#include "formats/file.h"
#include "formats/reader.h"
#include "formats/writer.h"
#include "golden.h"

namespace {

// Calls left until one fails; negative: none does. The linker puts these functions before the real
// ones.
long calls_left = -1;
bool tear = false;  // a failing write writes half first
int calls = 0;

bool fails() {
  ++calls;
  return calls_left >= 0 && calls_left-- == 0;
}

}  // namespace

extern "C" {
ssize_t __real_pwritev(int file, const iovec* parts, int count, off_t offset);
int __real_fdatasync(int file);
int __real_rename(const char* from, const char* to);

ssize_t __wrap_pwritev(int file, const iovec* parts, int count, off_t offset) {
  if (!fails()) return __real_pwritev(file, parts, count, offset);
  if (tear) static_cast<void>(::pwrite(file, parts[0].iov_base, parts[0].iov_len / 2, offset));
  errno = ENOSPC;
  return -1;
}

int __wrap_fdatasync(int file) {
  if (!fails()) return __real_fdatasync(file);
  errno = EIO;
  return -1;
}

int __wrap_rename(const char* from, const char* to) {
  if (!fails()) return __real_rename(from, to);
  errno = EROFS;
  return -1;
}
}

using namespace psf;
using namespace psf::formats;

namespace {

// Three passes of the golden records, small chunks. Returns the records that the writer said are
// committed.
std::uint64_t write_passes(const std::string& path, Codec codec, std::optional<Error>& error) {
  std::uint64_t committed = 0;
  try {
    Writer writer(path, test::golden_head(), {codec, true, test::golden_uuid()});
    try {
      for (std::size_t pass = 0; pass < 3; ++pass) {
        std::vector<test::Bytes> columns;
        std::vector<const void*> pointers;
        for (std::size_t k = 0; k < test::golden_head().channels.size(); ++k) {
          columns.push_back(test::golden_values(k, pass * test::kGoldenPass, test::kGoldenPass));
        }
        for (const auto& column : columns) pointers.push_back(column.data());
        writer.append(test::kGoldenPass, pointers);
        writer.commit();
        committed = writer.records();
      }
      writer.close();
    } catch (const Error& first) {
      error = first;
      // It sticks, even though the system works again.
      try {
        writer.close();
        FAIL("the error did not stick");
      } catch (const Error& second) {
        CHECK(std::string(second.what()) == first.what());
      }
      CHECK_THROWS_AS(writer.commit(), Error);
    }
  } catch (const Error& first) {
    error = first;
  }
  return committed;
}

void check_left_behind(const std::string& path, std::uint64_t committed) {
  CHECK_FALSE(std::filesystem::exists(path + ".partial"));
  if (committed == 0 && !std::filesystem::exists(path)) return;
  const Reader reader(path);
  CHECK(reader.records() == committed);
  // A torn hint is all that may be left of a failed write.
  for (const Fault& fault : check(path).faults) CHECK(fault.frame == "SLOT");
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
    if (test::read_all(reader, k) != test::golden_values(k, 0, committed)) ++wrong;
  }
  CHECK(wrong == 0);
}

}  // namespace

TEST_CASE("whichever write, sync or rename fails, the last commit is readable") {
  const test::Scratch scratch;
  for (const Codec codec : {Codec::raw, Codec::zstd}) {
    for (const bool torn : {false, true}) {
      const std::string path = scratch.path("w.pvb");
      std::optional<Error> error;
      calls = 0;
      calls_left = -1;
      CHECK(write_passes(path, codec, error) == 3 * test::kGoldenPass);
      CHECK_FALSE(error);
      const int total = calls;
      REQUIRE(total > 20);
      for (int n = 0; n < total; ++n) {
        std::filesystem::remove(path);
        error.reset();
        tear = torn;
        calls_left = n;
        const std::uint64_t committed = write_passes(path, codec, error);
        calls_left = -1;
        CAPTURE(n);
        REQUIRE(error);
        CHECK(error->code() == ErrorCode::io);
        CHECK(std::string(error->what()).find("w.pvb") != std::string::npos);
        check_left_behind(path, committed);
      }
    }
  }
}

TEST_CASE("a limit on file sizes is an error with a remedy, and the last commit is readable") {
  const test::Scratch scratch;
  const std::string path = scratch.path("w.pvb");
  std::optional<Error> error;
  static_cast<void>(write_passes(path, Codec::raw, error));
  const std::size_t whole = test::load(path).size();
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  for (std::size_t limit = 0; limit < whole; limit += 3333) {
    std::filesystem::remove(path);
    error.reset();
    const rlimit small{limit, old.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
    const std::uint64_t committed = write_passes(path, Codec::raw, error);
    ::setrlimit(RLIMIT_FSIZE, &old);
    REQUIRE(error);
    CHECK(std::string(error->what()).find("ulimit -f") != std::string::npos);
    check_left_behind(path, committed);
  }
  std::signal(SIGXFSZ, old_handler);
}

TEST_CASE("a full disk is an error with path and remedy") {
  try {
    File file = File::create("/dev/full");
    FAIL("a device was taken for a file");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::io);
  }
  const test::Scratch scratch;
  std::optional<Error> error;
  calls_left = 2;
  static_cast<void>(write_passes(scratch.path("w.pvb"), Codec::raw, error));
  calls_left = -1;
  REQUIRE(error);
  CHECK(std::string(error->what()).find("No space left on device; free some space") !=
        std::string::npos);
}
