// Sets of parameters that differ in r0 and delta alone share a traversal.
#pragma once

#include <cstddef>
#include <functional>
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

// Radii [first, first + count) of a group, which must outlive it.
struct Traversal {
  const VariantGroup* group;
  std::size_t first, count;

  // The set that radius k of the traversal is of.
  [[nodiscard]] std::size_t row(std::size_t k) const { return group->rows[first + k]; }
};

// Group after group, at most at_once(group) of its radii together.
[[nodiscard]] std::vector<Traversal> split(
    std::span<const VariantGroup> groups,
    const std::function<std::size_t(const VariantGroup&)>& at_once);

// The run of a traversal; passes and limits are left to the caller.
[[nodiscard]] ManyRun run_of(const Traversal& traversal);

}  // namespace psf::study
