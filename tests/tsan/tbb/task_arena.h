// TBB's isolate for builds with the thread sanitizer: no thread of parallel_for.h and task_group.h
// takes on another's work.
#pragma once

namespace tbb::this_task_arena {

template <class Body>
void isolate(const Body& body) {
  body();
}

}  // namespace tbb::this_task_arena
