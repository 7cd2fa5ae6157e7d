// Groups sets of parameters that differ only in r0 and delta, so that they share a traversal.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "filter/parameters/parameters.h"
#include "run/many_dump.h"

namespace psf::study {

struct VariantGroup {
  filter::Parameters parameters;      // those of the first set; `radii` replace their radius
  std::vector<filter::Radius> radii;  // all with the same basis and count
  std::vector<std::size_t> rows;      // for each radius the number of its set
};

// Groups the sets; the groups are in the order of their first sets.
[[nodiscard]] std::vector<VariantGroup> group_variants(std::span<const filter::Parameters> sets);

// Radii [first, first + count) of a group, which must outlive it.
struct Traversal {
  const VariantGroup* group;
  std::size_t first, count;

  // The number of the set to which radius k of the traversal belongs.
  [[nodiscard]] std::size_t row(std::size_t k) const { return group->rows[first + k]; }
};

// Splits the groups, one after the other, into traversals of at most at_once(group) radii.
[[nodiscard]] std::vector<Traversal> split(
    std::span<const VariantGroup> groups,
    const std::function<std::size_t(const VariantGroup&)>& at_once);

// The run of a traversal; the caller sets passes and limits.
[[nodiscard]] run::ManyRequest run_of(const Traversal& traversal);

}  // namespace psf::study
