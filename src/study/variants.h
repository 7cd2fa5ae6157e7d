// Sets of parameters that differ in r0 and delta alone share a traversal.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filter/parameters.h"
#include "study/many_dump.h"

namespace psf::study {

struct VariantGroup {
  filter::Parameters parameters;      // of the first; the radius is replaced by each of `radii`
  std::vector<filter::Radius> radii;  // of one basis and count
  std::vector<std::size_t> rows;      // which of the sets each radius is
};

// In the order of the first of each group.
[[nodiscard]] std::vector<VariantGroup> group_variants(std::span<const filter::Parameters> sets);

// A run with radii [first, first + count) of a group; passes and limits are left to the caller.
[[nodiscard]] ManyRun run_of(const VariantGroup& group, std::size_t first, std::size_t count);

}  // namespace psf::study
