// Parallel loops whose partition does not depend on the number of threads (oneTBB underneath).
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace psf::core {

// Calls body(begin, end) for [0, grain), [grain, 2 grain), ... up to count, in any order, on all
// threads. The ranges are fixed, so values that are reduced per range and then summed in order are
// the same for any number of threads. An exception of a body ends the loop and is thrown here.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

[[nodiscard]] inline std::size_t range_count(std::size_t count, std::size_t grain) {
  return (count + grain - 1) / grain;
}

// Runs work beside the caller, one piece at a time, on a thread that is idle.
class Aside {
 public:
  Aside();
  ~Aside();  // waits for the work; an exception of the work is lost
  Aside(const Aside&) = delete;
  Aside& operator=(const Aside&) = delete;

  // Starts `work`. Where there is only one thread, wait() runs it. Call wait() before the next
  // start().
  void start(std::function<void()> work);
  // Waits until the work is done, helping with it, and throws what it threw. Returns at once where
  // no work was started.
  void wait();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Calls `body`. While this thread waits in a parallel loop of `body`, it does not take up the work
// of an Aside, which could delay `body`.
void undisturbed(const std::function<void()>& body);

// Limits the threads of every parallel loop as long as the object exists. `threads` = 0: all cores.
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
