// The table `photons` of a dump: formats/README.md, "Tables".
#pragma once

#include <cstdint>
#include <vector>

#include "render/light/light_paths.h"
#include "render/loop/table_columns.h"
#include "render/sample/sampler.h"
#include "render/scene/space.h"

namespace psf::render {

struct PhotonRow {
  std::uint32_t path;  // in its pass
  Vec3 position, normal, direction;
  Rgb power;
  std::uint16_t depth;  // 0: light that comes straight
  std::uint32_t light, material;
};

[[nodiscard]] const std::vector<TableColumn<PhotonRow>>& photon_columns();

// The vertices of some of the `paths` light paths of a pass, in world units. Adds the number of
// rays to `rays`.
[[nodiscard]] std::vector<PhotonRow> trace_photon_rows(
    const Transport& transport, const Space& space, const SamplerSettings& sampler,
    std::uint64_t pass, std::uint64_t paths, const LightPaths::Some& some, std::uint64_t& rays);

}  // namespace psf::render
