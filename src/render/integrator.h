// From a camera ray to the record of its path: the one interface between light transport and the rest.
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

// Everything the path-vertex buffer keeps of one path; the symbols are those of src/filter/README.md.
struct PathRecord {
  bool has_vertex = false;    // x_i exists
  bool shaded = false;        // c_i was computed
  Vec3 position{0, 0, 0};     // x_i, world units
  Vec3 normal{0, 0, 0};       // n_i, unit shading normal on the side of the camera
  Rgb reflectance{0, 0, 0};   // rho_i, albedo
  Rgb throughput{0, 0, 0};    // alpha_i, of the camera segment up to x_i
  Rgb contribution{0, 0, 0};  // c_i, radiance scattered at x_i toward the camera, without emission
  Rgb unfiltered{0, 0, 0};    // u_i
  float distance = 0;         // d_i, length of the camera segment, world units
  std::uint32_t visibility = 0;  // bit l mod 32 set: light l was seen from x_i
  float hit_distance = 0;     // length of the first ray shot from x_i by scattering; infinity for a miss
  Vec3 direction{0, 0, 0};    // unit, from x_i toward where the camera segment came from
  std::uint32_t material = 0; // index in Scene::materials
  float roughness = 0;        // perceptual; 1 for diffuse
};

struct IntegratorSettings {
  std::string name = "path";         // path, direct, ao
  int max_depth = 16;                // most surface interactions a path
  int roulette_depth = 4;            // Russian roulette starts here
  float vertex_roughness = 0.3f;     // x_i: the first vertex with perceptual roughness of at least this
  std::uint32_t split = 1;           // continuations from x_i, averaged into c_i
  float ao_distance = std::numeric_limits<float>::infinity();  // ao: farther surfaces do not occlude
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
// Throws Error{usage} for an unknown name, listing those there are.
[[nodiscard]] std::unique_ptr<Integrator> make_integrator(const Scene& scene,
                                                          const IntegratorSettings& settings);
[[nodiscard]] const std::vector<std::string>& integrator_names();

}  // namespace psf::render
