// Virtual point lights: light reflected between surfaces by joining x_i to the vertices of light
// paths. The geometric term is bounded, and what that takes away is found by path tracing, so that
// the mean is that of `path` (Kollig and Keller 2006, "Illumination in the Presence of Weak
// Singularities").
#include <algorithm>
#include <cassert>

#include "core/interrupt.h"
#include "render/light/integrators.h"
#include "render/light/light_paths.h"
#include "render/light/vertex_integrator.h"

namespace psf::render {

namespace {

// The standard distance of the bound, as a part of that from the camera.
constexpr float kBounded = 0.06f;

using Vpls = std::vector<LightVertex>;

class VplIntegrator final : public VertexIntegrator {
 public:
  // `vpls`: of a pass; null where there is none yet, or where each path has its own.
  explicit VplIntegrator(std::shared_ptr<const LitScene> lit,
                         std::shared_ptr<const Vpls> vpls = nullptr)
      : VertexIntegrator(std::move(lit)), vpls_(std::move(vpls)) {}

  std::unique_ptr<const Integrator> for_pass(const SamplerSettings& sampler, std::uint64_t pass,
                                             std::uint64_t& rays) const override;

 private:
  [[nodiscard]] const IntegratorSettings& settings() const { return transport().settings(); }
  Rgb gather(const Vertex& x, const Segment& segment, Branch& branch) const override;
  Rgb gather_once(const Vertex& x, const Segment& segment, const Sampler& sampler,
                  std::uint64_t& rays, Tally& tally) const override;
  // Adds to `vpls` what `vertex` sends on by a lobe that is rough enough, if it has one.
  void keep(const LightVertex& vertex, Vpls& vpls) const;
  // The radiance that x scatters of what `vpl` sends, bounded.
  Rgb connect(const Vertex& x, const LightVertex& vpl, float near, std::uint64_t& rays) const;
  // The part of the light from y to x that virtual lights bring; the rest is left to scattering.
  // `near`: the distance to which the bound belongs.
  static float vpl_share(float cosine_x, float cosine_y, float distance_sq, float near) {
    const float allowed = distance_sq / (near * near), wanted = cosine_x * cosine_y;
    return wanted <= allowed ? 1 : allowed / wanted;
  }
  float near_distance(const Segment& segment) const {
    const float asked = settings().vpl_distance;
    return std::max(asked > 0 ? asked : kBounded * segment.distance, kLeastLength);
  }

  std::shared_ptr<const Vpls> vpls_;
};

std::unique_ptr<const Integrator> VplIntegrator::for_pass(const SamplerSettings& sampler,
                                                          std::uint64_t pass,
                                                          std::uint64_t& rays) const {
  if (settings().vpl_set == VplSet::pixel) return nullptr;
  auto vpls = std::make_shared<const Vpls>(
      LightPaths(transport())
          .collect<LightVertex>(
              sampler, pass, settings().vpl_paths, rays,
              [this](const LightVertex& vertex, Vpls& kept) { keep(vertex, kept); }));
  return std::make_unique<VplIntegrator>(lit(), std::move(vpls));
}

void VplIntegrator::keep(const LightVertex& vertex, Vpls& vpls) const {
  // A light at max_depth would be one surface too many for every x_i.
  if (vertex.at.bsdf.black() || vertex.depth >= settings().max_depth) return;
  // Light does not leave a body where it came in.
  if (vertex.at.bsdf.enters()) return;
  LightVertex vpl = vertex;
  const float threshold = settings().vertex_roughness;
  const std::uint8_t smooth = vpl.at.bsdf.smooth_lobes(threshold);
  if (smooth != 0) vpl.at.bsdf.keep(static_cast<std::uint8_t>(vpl.at.bsdf.lobes() & ~smooth));
  if (vpl.at.bsdf.perfect() || vpl.at.bsdf.roughness() < threshold) return;
  vpl.power *= 1 / static_cast<float>(settings().vpl_paths);
  vpls.push_back(vpl);
}

Rgb VplIntegrator::gather(const Vertex& x, const Segment& segment, Branch& branch) const {
  Rgb sum;
  Walk walk;
  Surface surface;
  if (!gather_direct(x, segment.depth, branch, walk, surface, sum) || !enter(walk)) return sum;
  Vertex y = transport().vertex(surface, walk);
  // Virtual lights do not stand for what comes through a body, or out of one.
  const bool covered = !walk.passed && !y.bsdf.enters();
  if (covered && transport().select_lobe(y, walk, branch.sampler)) {
    const float cosine_x = dot(x.surface.normal, walk.ray.direction);
    const float cosine_y = dot(y.surface.geometric_normal, y.out);
    const float share =
        vpl_share(cosine_x, cosine_y, length_sq(surface.position - x.surface.position),
                  near_distance(segment));
    if (share >= 1) return sum;
    walk.throughput *= 1 - share;
  }
  follow(y, walk, branch, sum);
  return sum;
}

Rgb VplIntegrator::gather_once(const Vertex& x, const Segment& segment, const Sampler& sampler,
                               std::uint64_t& rays, Tally& tally) const {
  Vpls own;
  if (settings().vpl_set == VplSet::pixel) {
    const LightPaths paths(transport());
    for (std::uint32_t k = 0; k < settings().vpl_paths && !core::overdue(); ++k) {
      Sampler numbers = sampler.split(k, settings().vpl_paths);
      paths.trace(k, numbers, rays, [&](const LightVertex& vertex) { keep(vertex, own); });
    }
  }
  assert(vpls_ != nullptr || settings().vpl_set == VplSet::pixel);
  tally.bounce();
  const float near = near_distance(segment);
  Rgb sum(0, 0, 0);
  for (const LightVertex& vpl : settings().vpl_set == VplSet::pixel ? own : *vpls_) {
    if (segment.depth + vpl.depth > settings().max_depth) continue;
    const Rgb radiance = connect(x, vpl, near, rays);
    if (is_black(radiance)) continue;
    if (tally.wants_diffuse()) {
      const Vec3 toward = normalize(vpl.at.surface.position - x.surface.position);
      tally.set_diffuse(x.bsdf.diffuse_share(x.local, x.frame.to_local(toward)));
    }
    tally.add(vpl.light, radiance);
    sum += radiance;
  }
  return sum;
}

Rgb VplIntegrator::connect(const Vertex& x, const LightVertex& vpl, float near,
                           std::uint64_t& rays) const {
  const Surface& y = vpl.at.surface;
  const Vec3 between = y.position - x.surface.position;
  const float distance_sq = length_sq(between);
  if (!(distance_sq > 0)) return {0, 0, 0};
  const Vec3 toward = between * (1 / std::sqrt(distance_sq));
  const Vec3 at_x = x.frame.to_local(toward);
  const float cosine_y = -dot(toward, y.geometric_normal);
  if (at_x.z <= 0 || dot(toward, x.surface.geometric_normal) <= 0 || cosine_y <= 0)
    return {0, 0, 0};
  // What y sends to x is as `path` finds it: scattered with the normal that x sees.
  const Frame seen(Surface::bent_into_sight(y.normal, y.geometric_normal, toward));
  const Vec3 arriving = seen.to_local(vpl.at.out);
  if (arriving.z <= 0) return {0, 0, 0};
  float no_pdf;
  const Rgb f = x.bsdf.evaluate(x.local, at_x, no_pdf) *
                vpl.at.bsdf.evaluate(seen.to_local(-toward), arriving, no_pdf);
  if (is_black(f)) return f;

  const Vec3 origin = x.surface.origin_toward(toward), target = y.origin_toward(-toward);
  const float through = transport().caster().transmittance(origin, target - origin, 1 - 0x1p-17f,
                                                           x.surface.time, rays);
  if (!(through > 0)) return {0, 0, 0};
  // evaluate() is times the cosine, which power has in it already.
  const float area = dot(vpl.at.out, y.geometric_normal) * distance_sq;
  return f * vpl.power *
         (vpl_share(at_x.z, cosine_y, distance_sq, near) * cosine_y / area * through);
}

}  // namespace

std::unique_ptr<Integrator> make_vpl_integrator(const Scene& scene,
                                                const IntegratorSettings& settings) {
  return std::make_unique<VplIntegrator>(std::make_shared<const LitScene>(scene, settings));
}

}  // namespace psf::render
