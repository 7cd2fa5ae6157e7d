// Ambient occlusion: the cosine-weighted share of directions in which x_i sees nothing near.
#include "render/light/frame.h"
#include "render/light/integrators.h"
#include "render/light/transport.h"

namespace psf::render {

namespace {

class AoIntegrator final : public Integrator {
 public:
  AoIntegrator(const Scene& scene, const IntegratorSettings& settings)
      : transport_(scene, settings) {}

  PathRecord trace(const Ray& camera_ray, Sampler& sampler, bool shade, std::uint64_t& rays,
                   const PathDetails& details) const override;
  const std::vector<LayerInfo>& layers() const override { return no_layers_; }
  std::vector<std::string> light_names() const override { return {}; }

 private:
  // Distance of what one direction from x meets; infinity for nothing within reach.
  float look(const Vertex& x, Sampler& sampler, std::uint64_t& rays) const;

  Transport transport_;
  std::vector<LayerInfo> no_layers_;
};

PathRecord AoIntegrator::trace(const Ray& camera_ray, Sampler& sampler, bool shade,
                               std::uint64_t& rays, const PathDetails&) const {
  const IntegratorSettings& settings = transport_.settings();
  PathRecord record;
  Walk walk;
  walk.ray = camera_ray;
  while (walk.depth++ < settings.max_depth) {
    Surface surface;
    const float distance = transport_.next_surface(walk, surface, sampler, rays);
    if (std::isinf(distance)) return record;
    record.coverage = 1;
    record.distance += distance;
    Vertex v = transport_.vertex(surface, walk);
    if (v.bsdf.black()) return record;
    if (!transport_.select_lobe(v, walk, sampler)) {
      if (!transport_.scatter(v, walk, sampler) || !transport_.survives(walk, sampler)) break;
      continue;
    }
    transport_.record_vertex(v, walk, record);
    record.roughness = 1;  // occlusion is the same from wherever it is looked at
    if (!shade) {
      record.hit_distance = std::numeric_limits<float>::quiet_NaN();
      return record;
    }
    record.shaded = true;
    std::uint32_t open = 0;
    for (std::uint32_t k = 0; k < settings.split; ++k) {
      Sampler branch = settings.split > 1 ? sampler.split(k, settings.split) : sampler;
      const float seen = look(v, branch, rays);
      if (k == 0) record.hit_distance = seen;
      open += std::isinf(seen) ? 1u : 0u;
    }
    const float visible = static_cast<float>(open) / static_cast<float>(settings.split);
    record.contribution = Rgb(visible, visible, visible);
    return record;
  }
  return record;
}

float AoIntegrator::look(const Vertex& x, Sampler& sampler, std::uint64_t& rays) const {
  const Vec3 direction = x.frame.to_world(cosine_hemisphere(sampler.next_2d()));
  // Below the geometric surface the surface itself is in the way.
  if (dot(direction, x.surface.geometric_normal) <= 0) return 0;
  Hit hit;
  const float reach = transport_.settings().ao_distance;
  const bool met =
      transport_.meets({x.surface.origin_toward(direction), normalize(direction), x.surface.time},
                       reach, sampler, hit, rays);
  return met ? hit.distance : std::numeric_limits<float>::infinity();
}

}  // namespace

std::unique_ptr<Integrator> make_ao_integrator(const Scene& scene,
                                               const IntegratorSettings& settings) {
  return std::make_unique<AoIntegrator>(scene, settings);
}

}  // namespace psf::render
