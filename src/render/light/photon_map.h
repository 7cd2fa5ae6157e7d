// The photons of a pass, and the light that they bring to a point.
#pragma once

#include <functional>
#include <vector>

#include "render/accel/point_index.h"
#include "render/light/light_paths.h"

namespace psf::render {

// Power that arrived at a surface. All lengths are those of the scene's space.
struct Photon {
  Vec3 position;
  Vec3 geometric_normal;  // on the side that it arrived at
  Vec3 direction;         // where it came from, unit
  Rgb power;              // flux
  std::uint32_t light;    // its number, the sky last
  std::int32_t depth;     // surfaces met since the light, with this one
};

class PhotonMap {
 public:
  // Traces the light paths of a pass, as LightPaths does, and keeps what may serve at an x_i: what
  // was reflected at least once, at surfaces as rough as x_i must be. `rays`: + those shot.
  PhotonMap(const Transport& transport, const SamplerSettings& sampler, std::uint64_t pass,
            std::uint64_t& rays);

  // Calls visit(photon, radiance) for each photon in the ball around x that has met at most
  // `most_depth` surfaces, in a fixed order, with its part of the radiance that x scatters.
  // Photons behind the surface, and on surfaces that are turned away by more than kTurned, are left
  // out: a ball must not reach around an edge or through a wall.
  static constexpr float kTurned = 0.5f;  // cosine between the geometric normals
  void estimate(const Vertex& x, float radius, int most_depth,
                const std::function<void(const Photon&, const Rgb&)>& visit) const;

  [[nodiscard]] const std::vector<Photon>& photons() const { return photons_; }

 private:
  std::vector<Photon> photons_;
  PointIndex index_;
};

}  // namespace psf::render
