// Parallel loops visit every index once, in ranges that do not depend on the number of threads.
#include "core/parallel.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "catch.h"

using psf::core::Aside;
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

TEST_CASE("ranges cover all from 0 to count without gap or overlap, whatever the threads") {
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

TEST_CASE("work aside is done once wait() returns, piece after piece, loops of its own included") {
  for (const std::size_t threads : {1u, 4u}) {
    const ThreadLimit limit(threads);
    Aside aside;
    aside.wait();
    std::atomic<std::size_t> sum{0};
    for (std::size_t piece = 1; piece <= 50; ++piece) {
      aside.start([&sum] {
        parallel_for(100, 7, [&sum](std::size_t begin, std::size_t end) { sum += end - begin; });
      });
      parallel_for(100, 7, [&sum](std::size_t begin, std::size_t end) { sum += end - begin; });
      aside.wait();
      REQUIRE(sum == 200 * piece);
    }
  }
}

TEST_CASE("what work aside throws arrives at wait(), once, and disturbs no loop of the caller") {
  Aside aside;
  aside.start([] {
    parallel_for(10, 1, [](std::size_t, std::size_t) { throw std::runtime_error("aside"); });
  });
  std::atomic<std::size_t> count{0};
  CHECK_NOTHROW(parallel_for(1000, 1, [&count](std::size_t, std::size_t) { ++count; }));
  CHECK(count == 1000);
  CHECK_THROWS_WITH(aside.wait(), "aside");
  CHECK_NOTHROW(aside.wait());
  aside.start([&count] { count = 1; });
  CHECK_NOTHROW(aside.wait());
  CHECK(count == 1);
}

TEST_CASE("work aside that nobody waits for is done before its Aside is gone") {
  std::atomic<bool> done{false};
  {
    Aside aside;
    aside.start([&done] { done = true; });
  }
  CHECK(done);
}

#ifndef __SANITIZE_THREAD__  // where each piece has a thread of its own
TEST_CASE("undisturbed loops leave work aside alone; with one thread wait() does it") {
  const ThreadLimit limit(1);
  Aside aside;
  std::atomic<bool> done{false};
  aside.start([&done] { done = true; });
  psf::core::undisturbed([] { parallel_for(1000, 1, [](std::size_t, std::size_t) {}); });
  CHECK_FALSE(done);
  aside.wait();
  CHECK(done);
}
#endif
