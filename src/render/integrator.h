// From a camera ray to the record of its path: the one interface between light transport and the
// rest.
//
// x_i is the first vertex of the camera segment whose roughness is at least `vertex_roughness`;
// perfect mirrors and glass never are. Where a coat is smoother than that over its diffuse base,
// one of the two is chosen at random and its probability divided out of alpha_i, so x_i lies on the
// base or on what the coat mirrors. The back of a one-sided material ends the path without a
// vertex.
//
// The pixel's value is the mean of u_i + alpha_i c_i, without bias but for max_depth. u_i holds
// what does not pass through x_i: emission met on the camera segment, that of x_i's own surface
// included; the sky; and light sampled at glossy vertices before x_i.
//
//   path    light sampling and scattering, combined by the power heuristic; Russian roulette. At
//   x_i every light
//           is sampled once where there are at most 32 besides the sky, else, as at all other
//           vertices, one by power. Bit l mod 32 of `visibility` is set where the sample of light l
//           was unoccluded; the sky has no bit. A constant sky is found by scattering alone, an
//           environment map is sampled too.
//   direct  the same without what is reflected between surfaces after x_i: path with the depth of
//   x_i. ao      c_i is grey, 1 where a cosine-weighted ray from x_i meets nothing within
//   ao_distance, else 0; u_i is 0
//           (lights and sky play no part), visibility 0.
//
// With `split`, c_i is the mean of that many continuations; visibility and hit_distance are the
// first one's.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/vec.h"
#include "render/sampler.h"
#include "render/scene.h"

namespace psf::render {

struct Ray {
  Vec3 origin, direction;  // direction is unit
};

// Everything the path-vertex buffer keeps of one path; the symbols are those of
// src/filter/README.md. An integrator's lengths are those of the scene's space, the file's those of
// the world.
struct PathRecord {
  bool has_vertex = false;    // x_i exists
  bool shaded = false;        // c_i was computed, or would have been
  Vec3 position{0, 0, 0};     // x_i
  Vec3 normal{0, 0, 0};       // n_i, unit shading normal on the side of the camera
  Rgb reflectance{0, 0, 0};   // rho_i, albedo
  Rgb throughput{0, 0, 0};    // alpha_i, of the camera segment up to x_i
  Rgb contribution{0, 0, 0};  // c_i, radiance scattered at x_i toward the camera, without emission
  Rgb unfiltered{0, 0, 0};    // u_i
  float distance = 0;         // d_i, length of the camera segment
  std::uint32_t visibility = 0;  // bit l mod 32 set: light l was seen from x_i
  float hit_distance = 0;  // length of the first ray scattered from x_i; infinity for a miss or
                           // absorption; NaN where there was none, because the path is not shaded
  Vec3 direction{0, 0, 0};     // unit, from x_i toward where the camera segment came from
  std::uint32_t material = 0;  // index in Scene::materials
  float roughness = 0;         // perceptual; 1 for diffuse
};

// The record of a path in a scene of this space, in world units.
[[nodiscard]] PathRecord in_world(PathRecord record, const Space& space);

struct IntegratorSettings {
  std::string name = "path";  // path, direct, ao
  int max_depth = 16;         // most surface interactions a path, the camera segment's included
  int roulette_depth = 4;     // Russian roulette starts after this many, never at x_i
  float vertex_roughness =
      0.3f;                 // x_i: the first vertex with perceptual roughness of at least this
  std::uint32_t split = 1;  // continuations from x_i, averaged into c_i
  // ao: farther surfaces do not occlude; world units
  float ao_distance = std::numeric_limits<float>::infinity();
};

class Integrator {
 public:
  virtual ~Integrator() = default;
  // Thread-safe. `shade` false: stop at x_i, c_i is not computed. Adds the rays it shot to `rays`.
  [[nodiscard]] virtual PathRecord trace(const Ray& camera_ray, Sampler& sampler, bool shade,
                                         std::uint64_t& rays) const = 0;
  // Names of the lights in the order of their visibility bits.
  [[nodiscard]] virtual std::vector<std::string> light_names() const = 0;
};

// Builds the acceleration structure (Embree) and the lights. The scene must outlive the integrator.
// Throws Error{usage} for an unknown name, listing those there are, and for settings out of range.
[[nodiscard]] std::unique_ptr<Integrator> make_integrator(const Scene& scene,
                                                          const IntegratorSettings& settings);
[[nodiscard]] const std::vector<std::string>& integrator_names();

}  // namespace psf::render
