// A lower limit for the filter's time: the innermost loops of the kernel, on data that stay in the
// first-level cache.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "filter/parameters/parameters.h"

namespace psf::filter::engine {

// A packet of queries and 256 sources, about 20 KB, placed so that bounds decide nothing: every
// pair is tested, for chi and for each term that is on.
class Floor {
 public:
  explicit Floor(const WeightTerms& terms);
  ~Floor();

  // Tests every pair `times` times; returns how many tests passed.
  std::uint64_t run(std::size_t times);

  // The number of pairs that run(1) tests.
  static constexpr std::size_t kPairs = std::size_t{16} * 256;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace psf::filter::engine
