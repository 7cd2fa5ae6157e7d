// The queries near each of some records, one list a record.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "filter/problem.h"

namespace psf::filter {

class Lists {
 public:
  // `near`: record numbers, in any order; it may hold records that a term of the weights refuses, and
  // may lack the centre itself.
  using Visit = std::function<void(std::size_t k, std::span<const std::uint32_t> near)>;

  virtual ~Lists() = default;
  // Calls visit for every centre k, once, on all threads. Throws Error{interrupted} on ^C.
  virtual void each(const Visit& visit) const = 0;
};

// All queries of `problem` with chi(x_i - x_j; reach[k]) = 1 that the weights of the problem do not
// refuse, where j = centers[k], in a compact order. All arguments are borrowed.
[[nodiscard]] std::unique_ptr<Lists> make_lists(EngineKind kind, const Problem& problem,
                                                std::span<const std::uint32_t> centers,
                                                std::span<const float> reach);

}  // namespace psf::filter
