// [average] of one block for many radii at once: what a sweep over r0 and delta asks.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "filter/average.h"

namespace psf::filter {

// Part of the result: some queries, and the radii [first, first + count) of all.
struct Slab {
  std::span<const std::uint32_t> queries;  // record numbers
  std::size_t first, count;
  std::span<const Rgb> c_bar;  // (queries, count)
};

// Beside the slabs.
struct ManyAverages {
  std::vector<Role> roles;             // of each record, as Average has them
  std::vector<Statistics> statistics;  // of each radius; the seconds are of all together
};

// The same as average() for each of `radii`, which replace parameters.radius and share its basis
// and count, but that sums are added in another order: every query of the block is in one slab for
// every radius. `on_slab` is called from one thread, always with the same slabs in the same order.
// One traversal for [average] and [disk]; iterations and the other estimators take one a radius.
// Throws what average() throws.
[[nodiscard]] ManyAverages average_many(const Records& records, const Block& block,
                                        const Parameters& parameters, std::span<const Radius> radii,
                                        const std::function<void(const Slab&)>& on_slab);

// Bytes beside those of memory_per_record(): of the slab, and of each record.
[[nodiscard]] std::uint64_t memory_of_slab(std::size_t radii);
inline constexpr std::uint64_t kManyBytesPerRecord = sizeof(double);

}  // namespace psf::filter
