// Turns a camera ray into the record of its path. This is the only interface between light
// transport and the rest of the program.
//
// x_i is the first vertex of the camera segment whose roughness is at least `vertex_roughness`;
// perfect mirrors and glass never qualify. Where only the diffuse base of a coat qualifies, coat or
// base is chosen at random and alpha_i is divided by its probability, so x_i lies on the base or on
// a surface seen in the coat. A path that meets the back of a one-sided material ends without a
// vertex.
//
// Where a path enters a body with a medium, that point is x_i, and what comes back from the body,
// wherever it leaves, is in c_i; a smooth boundary is divided as a coat is. A passage through a body
// is one surface interaction.
//
// In a medium between surfaces the first place where the path is scattered can be x_i too. Each such
// place counts as a surface interaction.
//
// The pixel's value is the mean of u_i + alpha_i c_i, without bias except that of max_depth. u_i is
// the light that does not pass through x_i: emission met on the camera segment, including that of
// x_i's own surface; the sky; and light sampled at glossy vertices before x_i.
//
//   path    Light sampling and scattering are combined by the power heuristic, with Russian
//           roulette. At x_i every light is sampled once where there are at most 32 besides the
//           sky. Where there are more, each that is likely to bring at least an eighth of the light
//           there is sampled once, and one of the others; by power, only one of all. At all other
//           vertices one light is sampled. Bit l mod 32 of `visibility` is set where the sample of
//           light l was unoccluded, or more than half of it came through blended surfaces; the sky
//           has no bit, and the one of the others has none: who has one is decided by the place
//           alone. By power, the one of all has one. A constant sky is found by scattering alone,
//           an environment map is sampled too.
//   direct  As `path`, but without light reflected between surfaces after x_i: the path ends at the
//           depth of x_i.
//   vpl     As `path`, but part of the light reflected between surfaces comes from virtual point
//           lights: the vertices of light paths, joined to x_i by shadow rays. Where a light would
//           be so near that it weighed too much, it is bounded, and what is then missing is found
//           by following the ray scattered from x_i as `path` does; so is what x_i gets from
//           mirrors, glass, and lobes smoother than vertex_roughness. The light paths are a set
//           that all paths of a pass share, or a set of each path's own. Unlike `path`, it also
//           finds what lights without extent send through mirrors and glass onto a surface that
//           x_i sees.
//   photon  As `direct`, and the light reflected between surfaces, caustics with it, is a density:
//           the power of the photons in a ball around x_i, times the BSDF, over the area of the
//           ball's disk. Photons are the vertices of light paths behind the first, a set for each
//           pass. The radius in pass p is photon_radius / sqrt((p + 1)^photon_delta), [radius] of
//           src/filter/README.md. This is biased, and the bias goes with the radius.
//   ao      c_i is grey: 1 where a cosine-weighted ray from x_i meets nothing within ao_distance,
//           else 0. u_i and visibility are 0; lights and sky have no influence.
//
// With `split`, c_i is the mean over that many continuations; visibility and hit_distance are those
// of the first.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/vec.h"
#include "render/light/layers.h"
#include "render/light/trail.h"
#include "render/sample/sampler.h"
#include "render/scene/scene.h"

namespace psf::render {

// What x_i lies on; the numbers are those of the channel `kind`.
enum class VertexKind : std::uint8_t { surface, curve, volume };

struct Ray {
  Vec3 origin, direction;  // direction is unit
  float time = 0;          // in [0, 1], of Scene::shutter
};

// Everything that the path-vertex buffer stores of one path; the symbols are those of
// src/filter/README.md. An integrator gives lengths in the unit of the scene's space; the file has
// them in world units.
struct PathRecord {
  bool has_vertex = false;    // x_i exists
  bool shaded = false;        // c_i was computed, or would have been
  Vec3 position{0, 0, 0};     // x_i
  Vec3 normal{0, 0, 0};       // n_i, unit shading normal on the side of the camera
  Rgb reflectance{0, 0, 0};   // rho_i, albedo
  Rgb throughput{0, 0, 0};    // alpha_i, throughput of the camera segment up to x_i
  Rgb contribution{0, 0, 0};  // c_i, radiance scattered at x_i toward the camera, without emission
  Rgb unfiltered{0, 0, 0};    // u_i
  float distance = 0;         // d_i, length of the camera segment
  std::uint32_t visibility = 0;  // bit l mod 32 set: light l was seen from x_i
  // Length of the first ray scattered from x_i; infinity for a miss or absorption; NaN where the
  // path is not shaded.
  float hit_distance = 0;
  Vec3 direction{0, 0, 0};     // omega_i, unit, from x_i to the previous vertex or the camera
  std::uint32_t material = 0;  // index in Scene::materials
  float roughness = 0;         // q_i, perceptual, of the smoothest lobe; 1 for diffuse
  // The channel `alpha`: 1 where the camera segment met anything, glass and mirrors too; 0 where it
  // went to the background. Not alpha_i.
  float coverage = 0;
  VertexKind kind = VertexKind::surface;
  Vec3 rest{0, 0, 0};  // x_i as it was at frame 0, as far as the scene keeps it
};

// Converts `record`, whose lengths and positions are those of `space`, to world units.
[[nodiscard]] PathRecord in_world(PathRecord record, const Space& space);

enum class VplSet : std::uint8_t {
  pass,  // one set of light paths for all paths of a pass
  pixel  // a set of its own for each path
};

// How one of the lights is chosen where not all of them are sampled.
enum class LightSampling : std::uint8_t {
  automatic,  // tree where there are more than 32 besides the sky, else power
  power,
  tree  // by what they may bring to the place, and so the triangles of emissive meshes
};

struct IntegratorSettings {
  std::string name = "path";      // path, direct, vpl, photon, ao
  int max_depth = 16;             // most surface interactions of a path, with the camera segment's
  int roulette_depth = 4;         // Russian roulette starts after this many, but never at x_i
  float vertex_roughness = 0.3f;  // x_i is the first vertex with at least this perceptual roughness
  std::uint32_t split = 1;        // continuations from x_i, averaged into c_i
  // For ao, in world units: surfaces farther away than this do not occlude.
  float ao_distance = std::numeric_limits<float>::infinity();
  LightSampling light_sampling = LightSampling::automatic;
  std::uint32_t vpl_paths = 16;  // light paths of a set
  VplSet vpl_set = VplSet::pass;
  // For vpl, in world units: the geometric term is bounded by 1 / vpl_distance^2; 0: by a part of the
  // distance d_i.
  float vpl_distance = 0;
  std::uint32_t photon_paths = 131072;  // light paths of a pass
  float photon_radius = 0;              // in world units; 0: a part of the distance d_i
  float photon_delta = 0.333333f;       // how the radius shrinks with the passes, 0 to < 1
  LayerKind layers = LayerKind::none;  // layers of the light that a path is divided into; not of ao
  // The most vertices of a path that its trail is to have; 0: no trail. For path and direct, without
  // split, whose paths are chains.
  std::uint32_t vertices = 0;
  std::uint32_t photons =
      0;  // light paths of a pass whose vertices are to be told; 0: none; not of ao
};

class Transport;

class Integrator {
 public:
  virtual ~Integrator() = default;
  // The integrator of one pass. Where the paths of a pass share something, such as light paths, it
  // is made here, on all threads, from the settings of the sampler and the pass alone, and adds to
  // `rays` what it shot; paths are then traced by the result, which may outlive this object. Null
  // where they share nothing, and this object traces the paths of every pass.
  [[nodiscard]] virtual std::unique_ptr<const Integrator> for_pass(const SamplerSettings& sampler,
                                                                   std::uint64_t pass,
                                                                   std::uint64_t& rays) const;
  // Traces a path. Without `shade` it stops at x_i, and c_i is not computed. Adds the number of
  // rays that it shot to `rays`. Of `details` it tells what is wanted: to each of the layers, which
  // are none or those of layers(), it adds its parts of c_i and u_i; the trail gets its vertices.
  // Thread-safe.
  [[nodiscard]] virtual PathRecord trace(const Ray& camera_ray, Sampler& sampler, bool shade,
                                         std::uint64_t& rays, const PathDetails& details) const = 0;
  [[nodiscard]] PathRecord trace(const Ray& camera_ray, Sampler& sampler, bool shade,
                                 std::uint64_t& rays) const {
    return trace(camera_ray, sampler, shade, rays, {});
  }
  // The scene as it is ready for rays, for those that start at the lights; null where this
  // integrator knows no light.
  [[nodiscard]] virtual const Transport* light_transport() const { return nullptr; }
  // Whether x_i can lie between the surfaces, in a medium.
  [[nodiscard]] virtual bool has_volumes() const { return false; }
  // The layers of the light, as IntegratorSettings::layers asks for them.
  [[nodiscard]] virtual const std::vector<LayerInfo>& layers() const = 0;
  // The names of the lights in the order of their numbers; light l has visibility bit l mod 32.
  [[nodiscard]] virtual std::vector<std::string> light_names() const = 0;
  // In words, which of them are tested at x_i; empty: all.
  [[nodiscard]] virtual std::string visibility_rule() const { return {}; }
};

// Builds the acceleration structure (Embree) and the lights. The scene must outlive the integrator.
// Throws Error{usage} for an unknown name, with a list of the known ones, and for settings out of
// range.
[[nodiscard]] std::unique_ptr<Integrator> make_integrator(const Scene& scene,
                                                          const IntegratorSettings& settings);
[[nodiscard]] const std::vector<std::string>& integrator_names();

}  // namespace psf::render
