// Reads the photons of a dump: formats/README.md, "Tables", the table `photons`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "filter/blocks.h"
#include "filter/parameters/parameters.h"
#include "filter/records.h"
#include "formats/read/reader.h"

namespace psf::run {

// The channels to read, by their place in the table.
struct PhotonChannels {
  std::size_t position, normal, direction, power;
  std::optional<std::size_t> material;
};

// The photons of a block with their memory, reused from block to block.
struct PhotonColumns {
  std::vector<Vec3> position, normal, direction;
  std::vector<Rgb> power;
  std::vector<std::uint32_t> material;
  std::uint32_t passes = 0;

  [[nodiscard]] filter::Photons view() const {
    return {position, normal, direction, power, material, passes};
  }
};

// The channels of photons that `parameters` use; none where the estimator takes no photons. Throws
// Error{bad_input} where there is no table, or a channel is missing or has another type.
[[nodiscard]] std::optional<PhotonChannels> photon_channels(const formats::Reader& reader,
                                                            const filter::Parameters& parameters);

// Reads all photons of every pass that the paths of `range` are of. Throws Error{bad_input} where
// one of these passes has none. Thread-safe.
void read_photons(const formats::Reader& reader, const PhotonChannels& channels,
                  const filter::PathRange& range, PhotonColumns& out);

// The number of photons of those passes.
[[nodiscard]] std::uint64_t count_photons(const formats::Reader& reader,
                                          const filter::PathRange& range);

// Bytes of a photon in memory.
[[nodiscard]] std::uint64_t photon_bytes(const PhotonChannels& channels);

}  // namespace psf::run
