// Parallel loops visit every index once, in ranges that do not depend on the number of threads.
#include "core/parallel.h"

#include <algorithm>
#include <mutex>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "catch.h"

using psf::core::parallel_for;
using psf::core::ThreadLimit;

namespace {

using Ranges = std::set<std::pair<std::size_t, std::size_t>>;

Ranges ranges_of(std::size_t count, std::size_t grain, std::size_t threads) {
  const ThreadLimit limit(threads);
  Ranges ranges;
  std::mutex mutex;
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    const std::lock_guard lock(mutex);
    ranges.emplace(begin, end);
  });
  return ranges;
}

}  // namespace

TEST_CASE("ranges cover [0, count) without gap or overlap, whatever the threads") {
  for (const std::size_t count : {0u, 1u, 7u, 8u, 9u, 1000u}) {
    const Ranges one = ranges_of(count, 8, 1);
    std::size_t at = 0;
    for (const auto& [begin, end] : one) {
      CHECK(begin == at);
      CHECK(end == std::min(count, begin + 8));
      at = end;
    }
    CHECK(at == count);
    CHECK(ranges_of(count, 8, 4) == one);
  }
}

TEST_CASE("an exception of a body is thrown by the loop") {
  CHECK_THROWS_AS(parallel_for(100, 1,
                               [](std::size_t begin, std::size_t) {
                                 if (begin == 42) throw std::runtime_error("42");
                               }),
                  std::runtime_error);
}

TEST_CASE("a thread limit holds while it lives") {
  const std::size_t before = psf::core::thread_count();
  {
    const ThreadLimit limit(1);
    CHECK(psf::core::thread_count() == 1);
  }
  CHECK(psf::core::thread_count() == before);
}
