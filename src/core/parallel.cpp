#include "core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <cassert>
#include <exception>
#include <utility>

#include "core/interrupt.h"

namespace psf::core {

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  const Interruptible* const caller = Interruptible::here();
  tbb::parallel_for(
      std::size_t{0}, range_count(count, grain),
      [&](std::size_t range) {
        const WorkFor whom(caller);
        body(range * grain, std::min(count, (range + 1) * grain));
      },
      tbb::simple_partitioner{});
}

struct Aside::State {
  tbb::task_group group;
  // Kept here: an exception that reached the group would cancel what it is part of.
  std::exception_ptr error;
  bool started = false;
};

Aside::Aside() : state_(std::make_unique<State>()) {}
Aside::~Aside() {
  state_->group.wait();
}

void Aside::start(std::function<void()> work) {
  assert(!state_->started);
  state_->started = true;
  state_->group.run([state = state_.get(), work = std::move(work)] {
    try {
      work();
    } catch (...) {
      state->error = std::current_exception();
    }
  });
}

void Aside::wait() {
  state_->group.wait();
  state_->started = false;
  if (const std::exception_ptr error = std::exchange(state_->error, nullptr)) {
    std::rethrow_exception(error);
  }
}

void undisturbed(const std::function<void()>& body) {
  tbb::this_task_arena::isolate(body);
}

struct ThreadLimit::State {
  // In place: a copy of a global_control ends the control when it is destroyed.
  explicit State(std::size_t threads)
      : control(tbb::global_control::max_allowed_parallelism, threads) {}
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(std::size_t threads) {
  const auto cores = static_cast<std::size_t>(tbb::info::default_concurrency());
  state_ = std::make_unique<State>(threads == 0 ? cores : threads);
}
ThreadLimit::~ThreadLimit() = default;

std::size_t thread_count() {
  return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
}

}  // namespace psf::core
