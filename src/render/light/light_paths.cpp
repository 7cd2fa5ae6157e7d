// From a light over surfaces, one path at a time.
#include "render/light/light_paths.h"

#include "render/sample/sampler_hash.h"

namespace psf::render {
namespace {

// Sets the numbers of light paths apart from those of pixels, which have the same seed.
constexpr std::uint64_t kLightSeed = 0xa0761d6478bd642fu;

}  // namespace

Sampler LightPaths::sampler(const SamplerSettings& settings, std::uint64_t pass,
                            std::uint64_t paths, std::uint64_t path) {
  SamplerSettings own = settings;
  own.enumeration = Enumeration::global;
  own.seed = mix(settings.seed ^ kLightSeed);
  return {own, 0, pass * paths + path};
}

void LightPaths::trace(std::uint64_t path, Sampler& sampler, std::uint64_t& rays,
                       const Visit& visit) const {
  const Vec2 where = sampler.next_2d(), whither = sampler.next_2d();
  const float choice = sampler.next_1d();
  const Accel& accel = transport_.accel();
  Emission emission;
  if (!transport_.lights().emit(accel.center(), accel.radius(), choice, where, whither, emission)) {
    return;
  }
  Walk walk;
  walk.ray = {emission.origin, emission.direction};
  const int max_depth = transport_.settings().max_depth;
  while (walk.depth < max_depth) {
    Surface surface;
    if (std::isinf(transport_.next_surface(walk, surface, sampler, rays))) return;
    ++walk.depth;
    const LightVertex vertex{transport_.vertex(surface, walk), emission.power * walk.throughput,
                             emission.light, path, walk.depth};
    visit(vertex);
    if (vertex.at.bsdf.black()) return;
    if (!transport_.scatter_power(vertex.at, walk, sampler)) return;
    while (walk.body != kNone) {
      const std::optional<Vertex> inside = transport_.next_inside(walk, sampler, rays);
      if (!inside || !transport_.scatter_power(*inside, walk, sampler)) return;
    }
    if (!transport_.survives(walk, sampler)) return;
  }
}

}  // namespace psf::render
