// Which values of a record the terms in use look at, as columns of 32-bit values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "filter/parameters.h"
#include "filter/records.h"

namespace psf::filter::engine {

// Records a group, groups a family, queries a packet: the values of the widest vector.
inline constexpr std::size_t kWidth = 16;

// Every column there may be: 3 of x_i and what the eight terms add.
inline constexpr std::size_t kMaxColumns = 16;

// First columns of what is in use; x_i is always at 0. Integers are kept as floats of the same
// bits.
struct ColumnPlan {
  explicit ColumnPlan(const WeightTerms& terms);

  std::size_t count = 3;
  std::optional<std::size_t> normal, reflectance, direction;                  // three columns
  std::optional<std::size_t> visibility, hit_distance, material, lobe_width;  // one

  // Integers are ordered as such.
  [[nodiscard]] bool is_integer(std::size_t column) const {
    return column == visibility || column == material;
  }

  // The columns, (count, kWidth), of as many records as `chosen` has, at most kWidth; the last one
  // fills the rest of a row.
  void gather(const Records& records, std::span<const std::uint32_t> chosen, float* out) const;
};

}  // namespace psf::filter::engine
