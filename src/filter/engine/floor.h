// The floor under the filter's time: the innermost loops of the kernel on data in the first-level
// cache.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "filter/parameters.h"

namespace psf::filter::engine {

// A packet of queries and a few hundred sources, about 20 KB, strewn so that no bounds decide
// anything: every pair is tested one by one, for chi and for each term that is on.
class Floor {
 public:
  explicit Floor(const WeightTerms& terms);
  ~Floor();

  // Tests every pair `times` over; returns how many passed.
  std::uint64_t run(std::size_t times);

  // Pairs tested by run(1).
  static constexpr std::size_t kPairs = 16 * 256;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace psf::filter::engine
