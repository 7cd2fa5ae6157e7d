// Bodies that are filled with a medium, for tests.
#pragma once

#include "analytic_support.h"

namespace psf::render::test {

struct Body {
  float albedo = 1, ior = 1, roughness = 0, g = 0, sigma_t = 1;
};

inline int add_body(Scene& scene, const Body& body) {
  Medium medium;
  medium.sigma_s = grey(body.sigma_t * body.albedo);
  medium.sigma_a = grey(body.sigma_t * (1 - body.albedo));
  medium.g = body.g;
  scene.media.push_back(medium);
  const int material = add_material(scene, MaterialKind::subsurface, 1);
  scene.materials.back().interior = static_cast<int>(scene.media.size()) - 1;
  scene.materials.back().ior = body.ior;
  scene.materials.back().roughness = body.roughness;
  return material;
}

}  // namespace psf::render::test
