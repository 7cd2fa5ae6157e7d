// Parallel loops whose partition does not depend on the number of threads (oneTBB underneath).
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace psf::core {

// Calls body(begin, end) for [0, grain), [grain, 2 grain), ... up to count, in any order, on all
// threads. The ranges are fixed, so what is reduced per range and then summed in order is the same
// for any number of threads. An exception of a body ends the loop and is thrown here.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

[[nodiscard]] inline std::size_t range_count(std::size_t count, std::size_t grain) {
  return (count + grain - 1) / grain;
}

// Work that goes on beside the caller's, one piece at a time, on a thread that has nothing else to
// do.
class Aside {
 public:
  Aside();
  ~Aside();  // waits; what the work throws is lost
  Aside(const Aside&) = delete;
  Aside& operator=(const Aside&) = delete;

  // Where there is but one thread it is wait() that does the work. Not before the last piece was
  // waited for.
  void start(std::function<void()> work);
  // Until it is done, helping; throws what it threw. Nothing where none was started.
  void wait();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Calls `body`, whose parallel loops leave work of an Aside to other threads: so it takes no longer
// than its own work.
void undisturbed(const std::function<void()>& body);

// Bounds the threads of every parallel loop while it lives. threads = 0: all cores.
class ThreadLimit {
 public:
  explicit ThreadLimit(std::size_t threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

[[nodiscard]] std::size_t thread_count();

}  // namespace psf::core
