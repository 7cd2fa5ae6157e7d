// The memory that estimate() needs for a block, so that a run can be refused before it starts.
#pragma once

#include <cstdint>

#include "filter/parameters/parameters.h"

namespace psf::filter {

// The most bytes per record that estimate() needs, radii included, in addition to the records
// themselves. The sort's 44 bytes are freed before the tree, which needs more, is built. Not
// counted are 20 bytes of scaled.h, which only a block with unusually large or small lengths needs.
[[nodiscard]] std::uint64_t memory_per_record(const Parameters& parameters);
// The most bytes per photon of a block that [density] needs, in addition to the photons themselves.
[[nodiscard]] std::uint64_t memory_per_photon(const Parameters& parameters);
// Bytes per record of a block that a window of frames needs in addition: what was averaged of the
// frame itself, and a pair of frames as one set.
[[nodiscard]] std::uint64_t memory_per_record_of_window(const Parameters& parameters,
                                                        std::uint64_t layers);
// Bytes per record in addition where vertices in volumes are filtered apart: the results of the
// others wait beside that run. `layers`: number of layers that are averaged.
[[nodiscard]] std::uint64_t memory_per_record_of_kinds(std::uint64_t layers);
// The most that a layer with contributions adds to memory_per_record().
[[nodiscard]] std::uint64_t memory_per_layer(const Parameters& parameters);

}  // namespace psf::filter
