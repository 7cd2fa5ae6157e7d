// Failing writes: whichever system call fails, the error sticks and the last commit is readable.
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <optional>

#include "catch.h"
#include "core/error.h"
#include "failing.h"
#include "file_bytes.h"
#include "formats/check/check.h"
#include "formats/layout/file.h"
#include "formats/read/reader.h"
#include "formats/write/writer.h"
#include "golden.h"

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
  // The first commit, where it got its name and only the folder could not be synced.
  if (committed == 0 && reader.records() == test::kGoldenPass) committed = test::kGoldenPass;
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

TEST_CASE("whichever write, sync, rename or close fails, the last commit is readable") {
  const test::Scratch scratch;
  int cases = 0;
  for (const Codec codec : {Codec::raw, Codec::zstd}) {
    for (const bool torn : {false, true}) {
      const std::string path = scratch.path("w.pvb");
      std::optional<Error> error;
      std::uint64_t committed = 0;
      test::calls().tear = torn;
      const auto write = [&] {
        std::filesystem::remove(path);
        error.reset();
        committed = write_passes(path, codec, error);
      };
      cases += test::fail_each(write, [&](int n) {
        CAPTURE(n);
        REQUIRE(error);
        CHECK(error->code() == ErrorCode::io);
        // The folder is synced too, when the file gets its name.
        CHECK(std::string(error->what()).find(scratch.path("")) == 0);
        check_left_behind(path, committed);
      });
      test::calls().tear = false;
    }
  }
  CAPTURE(cases);
  CHECK(cases > 100);
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
  test::calls().left = 2;
  static_cast<void>(write_passes(scratch.path("w.pvb"), Codec::raw, error));
  test::calls().left = -1;
  REQUIRE(error);
  CHECK(std::string(error->what()).find("No space left on device; free some space") !=
        std::string::npos);
}
