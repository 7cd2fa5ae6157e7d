// The common parts of all integrators: the scene prepared for rays, and the steps of a path.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "render/accel/accel.h"
#include "render/light/bsdf.h"
#include "render/light/frame.h"
#include "render/light/integrator.h"
#include "render/light/lights.h"
#include "render/light/media.h"
#include "render/light/opacity.h"
#include "render/light/stand.h"
#include "render/light/surface.h"
#include "render/light/tally.h"

namespace psf::render {

// One surface interaction: the surface, its scattering, and the direction to the previous vertex.
struct Vertex {
  Surface surface;
  Bsdf bsdf;
  Frame frame;
  Vec3 out;        // toward the previous vertex, unit
  Vec3 local;      // `out` in the frame
  Media media;     // on the side of `out`
  int bodies = 0;  // of the bodies with a medium in which it is, where it is in any
};

// Where light arrives that a vertex scatters.
[[nodiscard]] inline Receiver receiver_of(const Vertex& v) {
  return {v.surface.position, v.bsdf.everywhere() ? Vec3(0, 0, 0) : v.surface.normal};
}

// What turns f cos for radiance along `v.out`, with light that arrives along `toward`, into that for
// power that arrives from `v.out` and leaves along `toward`: both are one where the normal is not
// interpolated (Veach 1997, 5.3).
[[nodiscard]] inline float flux_correction(const Vertex& v, const Vec3& toward) {
  if (v.surface.normal == v.surface.geometric_normal) return 1;
  const Vec3 &s = v.surface.normal, &g = v.surface.geometric_normal;
  const float below = std::abs(dot(v.out, g) * dot(toward, s));
  return below > 0 ? std::abs(dot(v.out, s) * dot(toward, g)) / below : 0;
}

// The state of a path that is being traced.
struct Walk {
  Ray ray;
  Rgb throughput{1, 1, 1};
  float eta_scale = 1;  // change of the throughput by glass that is undone on leaving it
  float pdf = 0;        // density of ray.direction; 0 for perfect lobes and the camera
  Lights::Sampled sampled = Lights::Sampled::one;  // at the last vertex
  Receiver from{{0, 0, 0}};                        // the last vertex
  int depth = 0;                                   // surface interactions so far
  Trail* trail = nullptr;    // gets the vertices of the path, where they are wanted
  int body = kNone;          // material of the body in whose medium the walk is
  int bodies = 0;            // there: how many bodies of that medium overlap
  Rgb within{1, 1, 1};       // there: throughput since it came in
  std::uint64_t events = 0;  // there: how often it was scattered
  bool passed = false;       // it came through a body
  Media media;               // between the surfaces
};

class Transport {
 public:
  Transport(const Scene& scene, const IntegratorSettings& settings);

  [[nodiscard]] const IntegratorSettings& settings() const { return settings_; }
  [[nodiscard]] const Accel& accel() const { return accel_; }
  [[nodiscard]] const RayCaster& caster() const { return caster_; }
  [[nodiscard]] const Lights& lights() const { return lights_; }

  // Whether x_i can lie between the surfaces.
  [[nodiscard]] bool has_volumes() const { return has_volumes_; }
  // Puts a walk with the ray of a camera into the media in which that stands. Where `body` then is
  // one, next_inside() takes the walk on. Radiance is denser by the square of the index in a body, as
  // it is in glass.
  void begin(Walk& walk, std::uint64_t& rays) const;
  // Follows the walk's ray to the next surface, through masks and blended ones, and returns the
  // distance; infinity for a miss. Media between the surfaces are as if they were not there.
  [[nodiscard]] float next_surface(const Walk& walk, Surface& surface, Sampler& sampler,
                                   std::uint64_t& rays) const;
  // The same, where media between the surfaces count: the walk may come to a place in one, and the
  // throughput is what arrives there.
  [[nodiscard]] float arrive(Walk& walk, Surface& surface, Sampler& sampler,
                             std::uint64_t& rays) const;
  // Where the walk has arrived.
  [[nodiscard]] Vertex vertex(const Surface& surface, const Walk& walk) const;
  // Whether a surface is in the way up to origin + reach * direction; as for next_surface().
  [[nodiscard]] bool meets(Ray ray, float reach, Sampler& sampler, Hit& hit,
                           std::uint64_t& rays) const;

  // The emitted light that the walk's ray met at `surface`, or in the sky where it is null, times
  // the walk's throughput and weighted against light sampling. Adds it to `tally`.
  [[nodiscard]] Rgb met(const Walk& walk, const Surface* surface, Tally& tally) const;

  // The radiance that `v` scatters directly from the lights that are `sampled`, weighted against
  // scattering. Sets the visibility bit of each sampled light that `v` sees, by more than half
  // through what is blended; not that of the one of the others, with Sampled::strong. Adds
  // `throughput` times the radiance to `tally`.
  [[nodiscard]] Rgb direct(const Vertex& v, Lights::Sampled sampled, Sampler& sampler,
                           std::uint32_t& visibility, std::uint64_t& rays, Tally& tally,
                           const Rgb& throughput) const;

  // Where only one of two lobes is rough enough, keeps one of them at random and divides the
  // throughput by its probability. Returns whether `v` is then rough enough to be x_i.
  [[nodiscard]] bool select_lobe(Vertex& v, Walk& walk, Sampler& sampler) const;

  // Sends the walk on from `v`; false where it is absorbed.
  [[nodiscard]] bool scatter(const Vertex& v, Walk& walk, Sampler& sampler) const;
  // The same for a walk that carries power away from a light instead of radiance toward it.
  [[nodiscard]] bool scatter_power(const Vertex& v, Walk& walk, Sampler& sampler) const;
  // Takes a walk that scatter() sent into a body to where it next can be scattered by scatter(): its
  // boundary, from inside, or where it has one that does not refract, the next place in the medium.
  // Nothing where the walk ends, and where the pass is overdue (core/interrupt.h), which is dropped.
  // Media in bodies: subsurface.cpp.
  [[nodiscard]] std::optional<Vertex> next_inside(Walk& walk, Sampler& sampler,
                                                  std::uint64_t& rays) const;
  // Russian roulette; false where the path ends.
  [[nodiscard]] bool survives(Walk& walk, Sampler& sampler) const;

  // Writes everything about x_i that is known when the walk arrives there.
  void record_vertex(const Vertex& v, const Walk& walk, PathRecord& record) const;

 private:
  // Samples where light goes on from `v`, in the world. Sets `correction` to flux_correction(); 1
  // where the geometric normal took the place of the shading normal.
  [[nodiscard]] static bool sample_scattering(const Vertex& v, Sampler& sampler, BsdfSample& sample,
                                              Vec3& direction, float& correction);
  [[nodiscard]] static bool go_on(const Vertex& v, const BsdfSample& sample, const Vec3& direction,
                                  Walk& walk);
  // Russian roulette on what a walk lost in a body, and on how often it was scattered there.
  [[nodiscard]] static bool survives_inside(Walk& walk, Sampler& sampler);
  // For a surface that the walk met in a body: whether the walk passes on into another body of the
  // same medium, or out of one.
  [[nodiscard]] bool overlaps(const Surface& surface, int material, int& bodies) const;
  // From a place in a body through its boundary, which does not refract: false where a surface is in
  // the way. Moves `origin` off the boundary and multiplies `left` by the transmittance.
  [[nodiscard]] bool leaves_body(const Vertex& v, const LightSample& sample, Vec3& origin,
                                 Rgb& left, Sampler& sampler, std::uint64_t& rays) const;
  // Whether `surface` is the boundary of a volume, which a ray along `direction` then has crossed.
  [[nodiscard]] bool crosses(const Surface& surface, Media& media) const;
  // The share of the light of `sample` that comes to `origin` through masks and blended surfaces;
  // multiplies `left` by the transmittance of media.
  [[nodiscard]] float shines(Vec3 origin, const LightSample& sample, float time, Media media,
                             Rgb& left, Sampler& sampler, std::uint64_t& rays) const;
  // Tells the trail how `v` scatters.
  static void tell(const Vertex& v, const Walk& walk);
  // `expected`: how many samples of this light there are on the average.
  [[nodiscard]] Rgb direct_from(std::size_t light, float expected, const Vertex& v,
                                Sampler& sampler, std::uint32_t& visibility, std::uint64_t& rays,
                                Tally& tally, const Rgb& throughput) const;

  const Scene& scene_;
  IntegratorSettings settings_;
  Accel accel_;
  Shapes shapes_;
  RayCaster caster_;
  Lights lights_;
  bool has_volumes_;
  Stands stands_;
  std::vector<std::shared_ptr<const CoatAlbedo>> coats_;  // by material; equal ior share a table
  // By material: null where no light of many bounces between microfacets is kept.
  std::vector<std::shared_ptr<const CoatAlbedo>> metals_;
  std::shared_ptr<const CoatAlbedo> clear_;  // null where no material has a clear coat
};

}  // namespace psf::render
