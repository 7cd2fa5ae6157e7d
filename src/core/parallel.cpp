#include "core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace psf::core {

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  tbb::parallel_for(
      std::size_t{0}, range_count(count, grain),
      [&](std::size_t range) { body(range * grain, std::min(count, (range + 1) * grain)); },
      tbb::simple_partitioner{});
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
