// Where a camera stands: in no medium, in volumes, or in a body that is filled with a medium.
#pragma once

#include <ImathBox.h>

#include <array>
#include <map>
#include <vector>

#include "render/accel/accel.h"
#include "render/light/media.h"
#include "render/light/surface.h"
#include "render/scene/scene.h"

namespace psf::render {

// What a walk must know at its start. In a body of the kind subsurface `body` is the material of
// it, and `bodies` how many of its medium overlap there; `media` is around it.
struct Stand {
  Media media;
  int body = kNone, bodies = 0;
};

// Finds it by rays to infinity: a closed surface is around a place where more of its crossings lead
// out than in. Several rays decide by majority, so that one that meets an edge twice, or leaves by
// a hole, does not matter.
class Stands {
 public:
  // All of them must outlive this object. `in_volumes`: Media of walks are looked at.
  Stands(const Scene& scene, const Accel& accel, const Shapes& shapes, bool in_volumes);

  // At the origin of a camera ray. Adds the rays that this took to `rays`.
  [[nodiscard]] Stand at(const Vec3& place, float time, std::uint64_t& rays) const;

 private:
  // Materials of the surfaces around a place, the innermost first.
  using Around = std::vector<int>;

  [[nodiscard]] bool may_be_inside(const Vec3& place) const;
  [[nodiscard]] bool is_boundary(int material) const;
  [[nodiscard]] Stand found(const Vec3& place, float time, std::uint64_t& rays) const;
  [[nodiscard]] Around look(const Vec3& place, const Vec3& direction, float time,
                            std::uint64_t& rays) const;
  [[nodiscard]] Stand stand_in(const Around& around) const;

  const Scene& scene_;
  const Accel& accel_;
  const Shapes& shapes_;
  bool in_volumes_;
  std::vector<Imath::Box3f> boxes_;  // around the boundaries of a material each
  // Of cameras that stand still in a scene that does.
  std::map<std::array<float, 3>, Stand> known_;
};

}  // namespace psf::render
