// Path tracing with light sampling and multiple importance sampling; `direct` is the same cut short
// after x_i.
#include "render/light/integrators.h"
#include "render/light/transport.h"

namespace psf::render {

namespace {

class PathIntegrator final : public Integrator {
 public:
  PathIntegrator(const Scene& scene, const IntegratorSettings& settings)
      : transport_(scene, settings),
        plan_(settings.layers, transport_.lights()),
        indirect_(settings.name == "path") {}

  PathRecord trace(const Ray& camera_ray, Sampler& sampler, bool shade, std::uint64_t& rays,
                   const LayerSums& layers) const override;
  const std::vector<LayerInfo>& layers() const override { return plan_.layers(); }
  std::vector<std::string> light_names() const override { return transport_.lights().names(); }

 private:
  // Radiance that one continuation from x_i brings back: its part of c_i.
  Rgb gather(const Vertex& x, int depth, Sampler& sampler, std::uint32_t& visibility,
             float& hit_distance, std::uint64_t& rays, Tally tally) const;

  Transport transport_;
  LayerPlan plan_;
  bool indirect_;
};

PathRecord PathIntegrator::trace(const Ray& camera_ray, Sampler& sampler, bool shade,
                                 std::uint64_t& rays, const LayerSums& layers) const {
  const IntegratorSettings& settings = transport_.settings();
  PathRecord record;
  Walk walk;
  walk.ray = camera_ray;
  walk.from = camera_ray.origin;
  Tally seen = Tally::of_camera(plan_, layers);
  std::uint32_t no_bits = 0;
  for (;;) {
    Surface surface;
    const float distance = transport_.next_surface(walk, surface, rays);
    if (std::isinf(distance)) {
      record.unfiltered += transport_.met(walk, nullptr, seen);
      return record;
    }
    record.coverage = 1;
    record.distance += distance;
    record.unfiltered += transport_.met(walk, &surface, seen);
    if (walk.depth >= settings.max_depth) return record;
    ++walk.depth;
    Vertex v = transport_.vertex(surface, walk.ray.direction);
    if (v.bsdf.black()) return record;
    if (transport_.select_lobe(v, walk, sampler)) {
      transport_.record_vertex(v, walk, record);
      if (!shade) {
        // Whom it may be averaged with must be known: the same shadow rays, and nothing else.
        Tally none;
        static_cast<void>(transport_.direct(v, transport_.samples_every_light(), sampler,
                                            record.visibility, rays, none, walk.throughput));
        record.hit_distance = std::numeric_limits<float>::quiet_NaN();
        return record;
      }
      record.shaded = true;
      const std::uint32_t split = settings.split;
      if (split <= 1) {
        record.contribution = gather(v, walk.depth, sampler, record.visibility, record.hit_distance,
                                     rays, Tally::of_vertex(plan_, layers));
        return record;
      }
      float no_distance;
      for (std::uint32_t k = 0; k < split; ++k) {
        Sampler branch = sampler.split(k, split);
        record.contribution += gather(v, walk.depth, branch, k == 0 ? record.visibility : no_bits,
                                      k == 0 ? record.hit_distance : no_distance, rays,
                                      Tally::of_vertex(plan_, layers));
      }
      record.contribution *= 1 / static_cast<float>(split);
      for (Rgb& layer : layers.contribution) layer *= 1 / static_cast<float>(split);
      return record;
    }
    record.unfiltered += walk.throughput *
                         transport_.direct(v, false, sampler, no_bits, rays, seen, walk.throughput);
    walk.every_light = false;
    if (!transport_.scatter(v, walk, sampler) || !transport_.survives(walk, sampler)) {
      return record;
    }
  }
}

Rgb PathIntegrator::gather(const Vertex& x, int depth, Sampler& sampler, std::uint32_t& visibility,
                           float& hit_distance, std::uint64_t& rays, Tally tally) const {
  const bool every = transport_.samples_every_light();
  Rgb sum = transport_.direct(x, every, sampler, visibility, rays, tally, Rgb(1, 1, 1));
  hit_distance = std::numeric_limits<float>::infinity();
  Walk walk;
  walk.depth = depth;
  walk.every_light = every;
  if (!transport_.scatter(x, walk, sampler)) return sum;
  if (tally.wants_diffuse()) {
    tally.set_diffuse(walk.pdf > 0
                          ? x.bsdf.diffuse_share(x.local, x.frame.to_local(walk.ray.direction))
                          : Rgb(0, 0, 0));
  }
  tally.leave_vertex();
  std::uint32_t no_bits = 0;
  for (bool first = true;; first = false) {
    Surface surface;
    const float distance = transport_.next_surface(walk, surface, rays);
    if (first) hit_distance = distance;
    if (std::isinf(distance)) return sum + transport_.met(walk, nullptr, tally);
    sum += transport_.met(walk, &surface, tally);
    tally.bounce();
    if (!indirect_ || walk.depth >= transport_.settings().max_depth) return sum;
    ++walk.depth;
    const Vertex v = transport_.vertex(surface, walk.ray.direction);
    if (v.bsdf.black()) return sum;
    sum += walk.throughput *
           transport_.direct(v, false, sampler, no_bits, rays, tally, walk.throughput);
    walk.every_light = false;
    if (!transport_.scatter(v, walk, sampler) || !transport_.survives(walk, sampler)) return sum;
  }
}

}  // namespace

std::unique_ptr<Integrator> make_path_integrator(const Scene& scene,
                                                 const IntegratorSettings& settings) {
  return std::make_unique<PathIntegrator>(scene, settings);
}

}  // namespace psf::render
