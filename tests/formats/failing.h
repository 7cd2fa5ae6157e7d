// System calls that a test counts, lets fail or leaves out. The linker puts these before the real
// ones.
#pragma once

#include <atomic>
#include <cstdint>

namespace psf::test {

struct Calls {
  // How many calls of pwritev, fdatasync, rename, fsync, and close of a file open for writing
  // succeed before one fails; negative: none fails.
  long left = -1;
  bool tear = false;        // a write that fails writes half first
  int changes = 0;          // calls of these so far
  const char* failed = "";  // the last one that did
  std::atomic<long> reads = 0;
  std::atomic<std::uint64_t> bytes_read = 0;
  bool skip_sync = false;
};
[[nodiscard]] Calls& calls();

// While one lives, nothing waits for the disk: for tests of thousands of files.
class WithoutSync {
 public:
  WithoutSync() { calls().skip_sync = true; }
  ~WithoutSync() { calls().skip_sync = false; }
  WithoutSync(const WithoutSync&) = delete;
  WithoutSync& operator=(const WithoutSync&) = delete;
};

// Runs `work` once in full, then once for each call that it made, with that call failing.
// `after(n)` judges what is left each time; returns the number of calls.
template <class Work, class After>
int fail_each(const Work& work, const After& after) {
  Calls& state = calls();
  state.left = -1;
  state.changes = 0;
  work();
  const int total = state.changes;
  for (int n = 0; n < total; ++n) {
    state.left = n;
    work();
    state.left = -1;
    after(n);
  }
  return total;
}

}  // namespace psf::test
