// Whichever write, sync or rename fails: the error sticks, and the last commit is readable.
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>

#include "c_file.h"
#include "catch.h"
#include "formats/read/reader.h"
#include "golden.h"

namespace {

// Calls left until one fails; negative: none does. The linker puts these before the real ones.
long calls_left = -1;
bool tear = false;  // a failing write writes half first
int calls = 0;
std::string order;  // the calls in their order, as letters w, s, f and r

bool fails(char call) {
  ++calls;
  order += call;
  return calls_left >= 0 && calls_left-- == 0;
}

}  // namespace

extern "C" {
ssize_t __real_pwrite(int file, const void* from, size_t size, off_t offset);
ssize_t __real_pwrite64(int file, const void* from, size_t size, off64_t offset);
int __real_fdatasync(int file);
int __real_fsync(int file);
int __real_rename(const char* from, const char* to);

ssize_t __wrap_pwrite64(int file, const void* from, size_t size, off64_t offset) {
  if (!fails('w')) return __real_pwrite64(file, from, size, offset);
  if (tear) static_cast<void>(!__real_pwrite64(file, from, size / 2, offset));
  errno = ENOSPC;
  return -1;
}

ssize_t __wrap_pwrite(int file, const void* from, size_t size, off_t offset) {
  return __wrap_pwrite64(file, from, size, offset);
}

int __wrap_fdatasync(int file) {
  errno = EIO;
  return fails('s') ? -1 : __real_fdatasync(file);
}

int __wrap_fsync(int file) {
  errno = EIO;
  return fails('f') ? -1 : __real_fsync(file);
}

int __wrap_rename(const char* from, const char* to) {
  errno = EROFS;
  return fails('r') ? -1 : __real_rename(from, to);
}
}

using namespace psf;
using test::CFile;

namespace {

struct Written {
  std::uint64_t committed = 0;  // as the header says
  std::string error;
};

// Passes [first, first + 3), closed.
Written write_passes(const std::string& path, std::size_t first) {
  const CFile file(first == 0 ? test::create_golden(path, true) : test::resume_golden(path, true));
  for (std::size_t pass = first; pass < first + 3; ++pass)
    test::write_golden_pass(file.get(), pass);
  pvb_close(file.get());
  Written outcome = {file.info().records, file.error()};
  if (outcome.error.empty()) return outcome;
  // It sticks, even though the system works again.
  CHECK(pvb_close(file.get()) == PVB_IO);
  CHECK(test::write_golden_pass(file.get(), first) == PVB_IO);
  CHECK(file.error() == outcome.error);
  return outcome;
}

void check_left_behind(const std::string& path, const Written& outcome) {
  CHECK_FALSE(std::filesystem::exists(path + ".partial"));
  if (!std::filesystem::exists(path)) {
    CHECK(outcome.committed == 0);
    return;
  }
  // A failed sync of the folder leaves a whole first pass that was not promised. A torn hint is all
  // that may be left of a failed write.
  const std::uint64_t records = formats::Reader(path).records();
  CHECK((records == outcome.committed ||
         (outcome.committed == 0 && records == test::kGoldenPass &&
          outcome.error.find("sync the folder") != std::string::npos)));
  CHECK(test::golden_faults(path, records, true) == "");
}

}  // namespace

TEST_CASE("C: whichever write, sync or rename fails, the last commit is readable") {
  const test::Scratch scratch;
  const std::string path = scratch.path("w.pvb");
  for (const std::size_t first : {std::size_t{0}, std::size_t{3}}) {  // created; resumed
    for (const bool torn : {false, true}) {
      const auto start = [&] {
        std::filesystem::remove(path);
        if (first > 0) write_passes(path, 0);
        calls = 0;
      };
      start();
      CHECK(write_passes(path, first).error.empty());
      const int total = calls;
      REQUIRE(total > 15);
      for (int n = 0; n < total; ++n) {
        start();
        tear = torn;
        calls_left = n;
        Written outcome = write_passes(path, first);
        calls_left = -1;
        CAPTURE(n, outcome.error);
        REQUIRE(outcome.error.find("w.pvb: cannot ") != std::string::npos);
        CHECK(outcome.error.find('\n') == std::string::npos);
        if (first > 0 && outcome.committed == 0) outcome.committed = 3 * test::kGoldenPass;
        check_left_behind(path, outcome);
      }
    }
  }
}

TEST_CASE("C: chunks, sync, commit, sync, slot; with the first pass then the name") {
  const test::Scratch scratch;
  order.clear();
  const CFile file(test::create_golden(scratch.path("o.pvb"), true));
  CHECK(order == "ww");
  test::write_golden_pass(file.get(), 0);
  CHECK(order == "wwwwswswrf");
  test::write_golden_pass(file.get(), 1);
  pvb_close(file.get());
  CHECK(order ==
        "wwwwswswrf"
        "wwswsw"
        "swsw");
}

TEST_CASE("C: a limit on file sizes is an error with a remedy, and the last commit is readable") {
  const test::Scratch scratch;
  const std::string path = scratch.path("w.pvb");
  write_passes(path, 0);
  const std::size_t whole = test::load(path).size();
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  for (std::size_t limit = 0; limit < whole; limit += 3333) {
    std::filesystem::remove(path);
    const rlimit small{limit, old.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
    const Written outcome = write_passes(path, 0);
    ::setrlimit(RLIMIT_FSIZE, &old);
    CHECK(outcome.error.find("ulimit -f") != std::string::npos);
    check_left_behind(path, outcome);
  }
  std::signal(SIGXFSZ, old_handler);
}
