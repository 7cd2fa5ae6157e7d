// The rows about the floor: the speed of the kernel on data in the first-level cache, that of the
// whole filter beside it, and the speed with each instruction set.
#pragma once

#include <cstddef>
#include <vector>

#include "bench/filter_run.h"

namespace psf::bench {

// The kernel's pair tests per second on one thread, for chi alone and with the sample's terms;
// then, for every instruction set except the best, its speed as a share of the best one's.
[[nodiscard]] std::vector<Row> floor_rows(const Sample& sample, std::size_t repeat);

// The whole filter's pairs in the balls per second over the floor's pair tests per second with the
// same terms, on one thread, run in turn. It is above 1 where bounds decide so many whole groups
// that far fewer pairs are tested than there are.
[[nodiscard]] Row floor_share_row(const Sample& sample, const Reach& reach, std::size_t repeat);

// For every instruction set except the best: time of the whole filter with the best set / with this
// one, on one thread, run in turn.
[[nodiscard]] std::vector<Row> instruction_set_rows(const Sample& sample, const Reach& reach,
                                                    std::size_t repeat);

}  // namespace psf::bench
