// The floor's rows: what the kernel reaches on data in the first-level cache, how near the whole
// filter comes to it, and what each instruction set is worth.
#pragma once

#include <cstddef>
#include <vector>

#include "bench/filter_run.h"

namespace psf::bench {

// Pair tests a second of the kernel, chi alone and with the sample's terms; then, for every
// instruction set but the best, what it reaches of that. One thread.
[[nodiscard]] std::vector<Row> floor_rows(const Sample& sample, std::size_t repeat);

// Of the whole filter, in turn with the floor, one thread: pairs in the balls a second over the
// floor's pair tests a second with the same terms. Above 1 where whole groups are taken or left by
// their bounds, so that fewer pairs are tested than there are.
[[nodiscard]] Row floor_share_row(const Sample& sample, const Reach& reach, std::size_t repeat);

// For every instruction set but the best: time of the whole filter with the best / with this one,
// in turn, one thread.
[[nodiscard]] std::vector<Row> instruction_set_rows(const Sample& sample, const Reach& reach,
                                                    std::size_t repeat);

}  // namespace psf::bench
