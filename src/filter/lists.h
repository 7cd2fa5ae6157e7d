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
  // `near`: record numbers, in any order.
  using Visit = std::function<void(std::size_t k, std::span<const std::uint32_t> near)>;

  virtual ~Lists() = default;
  // Calls visit for every centre k, once, on all threads. Throws Error{interrupted} on ^C.
  virtual void each(const Visit& visit) const = 0;
};

// All queries i of `problem` with chi(x_i - x_j; reach[k]) = 1 and w_ij = w_ji = 1, but for j itself,
// where j = centers[k], in a compact order. All arguments are borrowed.
[[nodiscard]] std::unique_ptr<Lists> make_lists(EngineKind kind, const Problem& problem,
                                                std::span<const std::uint32_t> centers,
                                                std::span<const float> reach);

}  // namespace psf::filter
