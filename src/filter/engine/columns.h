// The values of records that the terms in use compare, as columns of 32-bit values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "filter/parameters/parameters.h"
#include "filter/records.h"

namespace psf::filter::engine {

// The number of records in a group, of nodes in a family, of queries in a packet, and of values in
// the widest vector.
inline constexpr std::size_t kWidth = 16;

// The most columns there may be: 3 for x_i, the others for the eight terms.
inline constexpr std::size_t kMaxColumns = 16;

// The first column of each value in use; x_i always begins at 0. Integers are kept as floats of the
// same bits.
struct ColumnPlan {
  explicit ColumnPlan(const WeightTerms& terms);

  std::size_t count = 3;
  std::optional<std::size_t> normal, reflectance, direction;                  // three columns each
  std::optional<std::size_t> visibility, hit_distance, material, lobe_width;  // one column each

  // Whether the bits of a column are integers, which are to be compared as integers.
  [[nodiscard]] bool is_integer(std::size_t column) const {
    return column == visibility || column == material;
  }

  // Writes the columns, (count, kWidth), of the records `chosen`, at most kWidth of them. The last
  // record is repeated up to the end of each row.
  void gather(const Records& records, std::span<const std::uint32_t> chosen, float* out) const;
};

}  // namespace psf::filter::engine
