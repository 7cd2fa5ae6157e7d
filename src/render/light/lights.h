// All light sources of a scene: samples them from a point, and weights the light that scattering
// finds by the density of these samples.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "render/light/distribution.h"
#include "render/light/environment.h"
#include "render/light/integrator.h"
#include "render/light/light_tree.h"
#include "render/light/opacity.h"
#include "render/light/placed_choice.h"
#include "render/light/surface.h"

namespace psf::render {

struct LightSample {
  Vec3 direction;  // unit, toward the light
  Vec3 target;     // point on the light, just off its surface; undefined for lights at infinity
  bool infinite;
  Rgb weight;  // radiance / pdf; for lights without extent: irradiance on a facing surface
  float pdf;   // per solid angle; 0 for a light without extent, which scattering never hits
};

// Light that leaves its source.
struct Emission {
  Vec3 origin;     // just off the light's surface; of lights at infinity, outside the scene
  Vec3 direction;  // unit
  // Flux over the density of this ray: the mean over rays is the flux of all lights, of those at
  // infinity what passes through a disk of the scene's radius.
  Rgb power;
  std::size_t light;  // its number, Lights::count() for the sky
};

// Lights are numbered: first Scene::lights, then emissive meshes, then emissive spheres, each in
// the scene's order. An emissive surface of zero area is not a light. The sky has the number
// count(), but no visibility bit, and can be sampled where it is a map. A directional light with an
// angle is a disk in the sky that rays can meet.
class Lights {
 public:
  // Where there are at most this many lights, all are sampled at x_i. Light l has the visibility
  // bit l mod kEveryLight.
  static constexpr std::size_t kEveryLight = 32;

  // Tells `shapes` which surfaces emit. `radius`: that of a sphere around the scene. The scene must
  // outlive this object.
  Lights(const Scene& scene, Shapes& shapes, float radius,
         LightSampling sampling = LightSampling::automatic);

  [[nodiscard]] std::size_t count() const { return lights_.size(); }  // without the sky
  [[nodiscard]] bool sky_sampled() const { return sky_.sampled(); }
  [[nodiscard]] bool has_sky() const { return !sky_.black(); }
  [[nodiscard]] std::vector<std::string> names() const;

  // Samples a point on light `light`, or the sky for count(), as seen from `from`, which receives
  // light as `at`. Returns false where no light from it can arrive there. Lights without extent do
  // not use `u`.
  [[nodiscard]] bool sample(std::size_t light, const Surface& from, const Receiver& at,
                            const Vec2& u, LightSample& sample) const;
  [[nodiscard]] bool has_extent(std::size_t light) const;

  // choose() chooses one light, or the sky: by power, or where lights are chosen by place by what
  // they may bring to `at`. choices() is the number of candidates; where it is 0, choose() must not
  // be called. A probability of 0 says that no light arrives.
  [[nodiscard]] std::size_t choices() const { return choice_.total() > 0 ? choice_.size() : 0; }
  [[nodiscard]] std::size_t choose(const Receiver& at, float u, float& probability) const;

  // Which lights a vertex samples.
  enum class Sampled : std::uint8_t {
    one,     // that of choose()
    every,   // each once, and the sky
    strong,  // as PlacedChoice::plan() has it
  };
  // Which ones x_i samples.
  [[nodiscard]] Sampled at_vertex() const {
    return count() <= kEveryLight ? Sampled::every : placed_ ? Sampled::strong : Sampled::one;
  }
  // Only with Sampled::strong.
  [[nodiscard]] const PlacedChoice& placed() const { return *placed_; }

  // Sends light out, from a light or the sky, constant or not, that is chosen by power with `choice`.
  // `where` and `whither` place the ray. The surfaces lie in the sphere around `center`. Returns
  // false where no light comes from there, or none is to be had at all.
  [[nodiscard]] bool emit(const Vec3& center, float radius, float choice, const Vec2& where,
                          const Vec2& whither, Emission& emission) const;

  // A ray that scattering sent from `from`. `pdf`: density of `direction` by scattering, 0 for a
  // perfect lobe and for the camera, with which light sampling does not compete.
  struct Arrival {
    Receiver from;
    Vec3 direction;
    float pdf;
    Sampled sampled;  // at `from`
  };
  // Radiance that `hit` emits toward the arrival's origin, weighted against light sampling.
  [[nodiscard]] Rgb emitted(const Arrival& arrival, const Surface& hit) const;
  // Radiance that arrives from infinity, weighted against light sampling. Calls add(light, part)
  // for the part of the sky, which is light count(), and of each sun that is met.
  template <class Add>
  [[nodiscard]] Rgb escaped(const Arrival& arrival, const Add& add) const {
    Rgb sum = from_sky(arrival);
    add(count(), sum);
    for (const std::size_t sun : suns_) {
      const Rgb part = from_sun(arrival, sun);
      if (is_black(part)) continue;
      sum += part;
      add(sun, part);
    }
    return sum;
  }

 private:
  enum class Kind : std::uint8_t { point, spot, directional, sun, mesh, sphere };
  struct Record {
    Kind kind;
    bool both_sides = false;
    Rgb radiance;      // point, spot: intensity; directional: irradiance; else radiance
    Vec3 position;     // sphere: centre
    Vec3 direction;    // directional, sun: toward the light; spot: along its axis
    float extent = 0;  // sphere: radius; sun: 1 - cos of its angular radius; mesh: 1 / area
    float cos_inner = 1, cos_outer = 0;
    const Texture* texture = nullptr;  // texture of the emission
    Opacity opacity;                   // of mesh and sphere
    const Mesh* mesh = nullptr;
    const Sphere* sphere = nullptr;  // where it moves
    std::size_t first = 0;           // mesh: its first triangle in triangles_
    int tree = kNone;                // mesh: of its triangles, in trees_
    Distribution areas;              // mesh
  };
  struct Triangle {
    Vec3 corner, edge1, edge2;
    Vec3 normal;  // unit
    float offset;
  };

  float add(const Light& light, float radius);  // these return the power
  float add(const Mesh& mesh, const Scene& scene);
  float add(const Sphere& sphere, const Scene& scene);
  [[nodiscard]] static Rgb radiance(const Record& light, const Vec2& uv);
  // The same on the average over what rays meet there: its share that is not there emits nothing.
  [[nodiscard]] static Rgb mean_radiance(const Record& light, const Vec2& uv);
  // A triangle of a mesh where it is at a time. It is chosen by its share of the area at the frame,
  // so the density of points on it is 1 / area of the mesh, over Surface::stretch.
  [[nodiscard]] Triangle triangle_at(const Record& light, std::size_t k, float time,
                                     float& stretch) const;
  // A sphere that moves, where it is at a time.
  [[nodiscard]] static Record sphere_at(const Record& light, float time);
  // These fill everything but the number of the light. `choice` takes one of two sides.
  void emit_mesh(const Record& light, float choice, Vec2 where, const Vec2& whither,
                 Emission& emission) const;
  static void emit_sphere(const Record& light, float choice, const Vec2& where, const Vec2& whither,
                          Emission& emission);
  static void emit_point(const Record& light, const Vec2& whither, Emission& emission);
  // Of the sky for null.
  void emit_far(const Record* light, const Vec3& center, float radius, const Vec2& where,
                const Vec2& whither, Emission& emission) const;
  [[nodiscard]] Vec2 texture_point(const Record& light, std::size_t triangle, float b1,
                                   float b2) const;
  // The share of a spot's intensity at this cosine from its axis.
  [[nodiscard]] static float spot_share(const Record& light, float cosine);
  [[nodiscard]] bool sample_mesh(const Record& light, const Surface& from, const Receiver& at,
                                 Vec2 u, LightSample& sample) const;
  // Chooses a triangle of a mesh; returns the density of points on it where it stands still.
  [[nodiscard]] float choose_triangle(const Record& light, const Receiver& at, float& u,
                                      std::size_t& k) const;
  [[nodiscard]] float area_density(const Record& light, std::size_t k, float probability) const;
  // `own`: whether `from` lies on the inside of this sphere.
  [[nodiscard]] static bool sample_sphere(const Record& light, const Surface& from, bool own,
                                          const Vec2& u, LightSample& sample);
  [[nodiscard]] static float sphere_pdf(const Record& light, const Vec3& from, bool inside);
  // How many samples of a light there were on the average where the arrival comes from.
  [[nodiscard]] float expected(const Arrival& arrival, std::size_t light) const;
  [[nodiscard]] float weight(const Arrival& arrival, std::size_t light, float pdf) const;
  // Makes the trees; `powers` by light.
  void place(const std::vector<float>& powers, float radius);
  [[nodiscard]] LightBounds bounds_of(Record& light, double intensity, float nearest);
  [[nodiscard]] Rgb from_sky(const Arrival& arrival) const;
  [[nodiscard]] Rgb from_sun(const Arrival& arrival, std::size_t sun) const;

  std::vector<Record> lights_;
  std::vector<std::string> names_;
  std::vector<Triangle> triangles_;
  std::vector<std::size_t> suns_;
  EnvironmentLight sky_;
  Distribution choice_;
  Distribution emission_;  // choice_, and a constant sky
  std::optional<PlacedChoice> placed_;
  std::vector<LightTree> trees_;
};

}  // namespace psf::render
