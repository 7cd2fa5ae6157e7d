// TBB's task_group for builds with the thread sanitizer, as parallel_for.h beside it: a thread a
// task.
#pragma once

#include <thread>
#include <utility>
#include <vector>

namespace tbb {

class task_group {
 public:
  ~task_group() { wait(); }
  template <class Task>
  void run(Task&& task) {
    threads_.emplace_back(std::forward<Task>(task));
  }
  void wait() {
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

 private:
  std::vector<std::thread> threads_;
};

}  // namespace tbb
