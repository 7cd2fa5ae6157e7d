// What all integrators share: the scene ready for rays, and one vertex of a path.
#pragma once

#include <memory>
#include <vector>

#include "render/accel.h"
#include "render/bsdf.h"
#include "render/frame.h"
#include "render/integrator.h"
#include "render/lights.h"
#include "render/surface.h"

namespace psf::render {

// One surface interaction: where, how it scatters, and the direction toward where the path came
// from.
struct Vertex {
  Surface surface;
  Bsdf bsdf;
  Frame frame;
  Vec3 out;    // toward the previous vertex, unit
  Vec3 local;  // the same in the frame
};

// The end of a path that still travels.
struct Walk {
  Ray ray;
  Rgb throughput{1, 1, 1};
  float eta_scale = 1;       // what glass took from the throughput only to give it back on leaving
  float pdf = 0;             // of ray.direction by scattering; 0 for perfect lobes and the camera
  bool every_light = false;  // the last vertex sampled every light
  Vec3 from{0, 0, 0};        // the last vertex
  int depth = 0;             // surface interactions so far
};

class Transport {
 public:
  // At most this many lights are all sampled at x_i; visibility bits are light mod this.
  static constexpr std::size_t kEveryLight = 32;

  Transport(const Scene& scene, const IntegratorSettings& settings);

  [[nodiscard]] const IntegratorSettings& settings() const { return settings_; }
  [[nodiscard]] const Accel& accel() const { return accel_; }
  [[nodiscard]] const Lights& lights() const { return lights_; }
  [[nodiscard]] bool samples_every_light() const { return lights_.count() <= kEveryLight; }

  // Follows the walk's ray to the next surface and returns its length; infinity for a miss.
  [[nodiscard]] float next_surface(const Walk& walk, Surface& surface, std::uint64_t& rays) const;
  [[nodiscard]] Vertex vertex(const Surface& surface, const Vec3& direction) const;

  // Light that the walk met at `surface` (a miss where null), by its last scattering alone, times
  // its throughput.
  [[nodiscard]] Rgb met(const Walk& walk, const Surface* surface) const;

  // Radiance scattered at `v` straight from the lights, weighted against scattering. `every`: each
  // light once, else one by power. Sets the bit of each light that `v` sees among those sampled.
  [[nodiscard]] Rgb direct(const Vertex& v, bool every, Sampler& sampler, std::uint32_t& visibility,
                           std::uint64_t& rays) const;

  // Where the material is rough enough in one lobe only, keeps one of the two at random and divides
  // the throughput by its probability. True where `v` then is a vertex worth filtering, x_i.
  [[nodiscard]] bool select_lobe(Vertex& v, Walk& walk, Sampler& sampler) const;

  // Sends the walk on from `v`; false where it is absorbed.
  [[nodiscard]] bool scatter(const Vertex& v, Walk& walk, Sampler& sampler) const;
  // Russian roulette; false where the path ends.
  [[nodiscard]] bool survives(Walk& walk, Sampler& sampler) const;

  // Everything about x_i that is known once the walk has arrived there.
  void record_vertex(const Vertex& v, const Walk& walk, PathRecord& record) const;

 private:
  [[nodiscard]] Rgb direct_from(std::size_t light, float probability, const Vertex& v,
                                Sampler& sampler, std::uint32_t& visibility,
                                std::uint64_t& rays) const;

  const Scene& scene_;
  IntegratorSettings settings_;
  Accel accel_;
  Shapes shapes_;
  Lights lights_;
  std::vector<std::shared_ptr<const CoatAlbedo>> coats_;  // by material, shared by those of one ior
};

}  // namespace psf::render
