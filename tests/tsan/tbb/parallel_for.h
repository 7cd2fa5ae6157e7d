// TBB's parallel_for for builds with the thread sanitizer, in place of the real one: its library is
// not instrumented, so that every hand-over of work in it looks like a race. This one starts
// threads, which the sanitizer understands.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace tbb {

struct simple_partitioner {};

template <class Index, class Body>
void parallel_for(Index first, Index last, const Body& body, simple_partitioner = {}) {
  constexpr std::size_t kThreads = 4;
  thread_local bool nested = false;
  if (nested || last - first < 2) {
    for (; first < last; ++first) body(first);
    return;
  }
  std::atomic<Index> next{first};
  std::exception_ptr error;
  std::mutex mutex;
  const auto work = [&] {
    nested = true;
    try {
      for (Index i = next++; i < last; i = next++) body(i);
    } catch (...) {
      next = last;
      const std::lock_guard lock(mutex);
      if (!error) error = std::current_exception();
    }
    nested = false;
  };
  std::vector<std::thread> threads;
  for (std::size_t k = 1; k < kThreads; ++k) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace tbb
