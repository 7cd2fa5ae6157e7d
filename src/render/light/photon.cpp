// Photon mapping: `direct`, and the density of photons around x_i for what is reflected between
// surfaces. The radius shrinks with the passes as that of progressive photon mapping does (Hachisuka
// et al. 2008; passes that know only their number: Knaus and Zwicker 2011).
#include <algorithm>
#include <cassert>

#include "render/light/integrators.h"
#include "render/light/photon_map.h"
#include "render/light/vertex_integrator.h"

namespace psf::render {

namespace {

// The standard radius, as a part of the distance from the camera.
constexpr float kRadius = 0.01f;

class PhotonIntegrator final : public VertexIntegrator {
 public:
  // `map`: of a pass; `shrunk`: its radius over that of the first.
  explicit PhotonIntegrator(std::shared_ptr<const LitScene> lit,
                            std::shared_ptr<const PhotonMap> map = nullptr, float shrunk = 1)
      : VertexIntegrator(std::move(lit)), map_(std::move(map)), shrunk_(shrunk) {}

  std::unique_ptr<const Integrator> for_pass(const SamplerSettings& sampler, std::uint64_t pass,
                                             std::uint64_t& rays) const override {
    const IntegratorSettings& settings = transport().settings();
    const auto number = static_cast<double>(pass + 1);
    const double shrunk = std::pow(number, -0.5 * double{settings.photon_delta});
    return std::make_unique<PhotonIntegrator>(
        lit(), std::make_shared<const PhotonMap>(transport(), sampler, pass, rays),
        static_cast<float>(shrunk));
  }

 private:
  Rgb gather(const Vertex& x, const Segment& segment, Branch& branch) const override {
    Rgb sum;
    Walk walk;
    Surface surface;
    // Photons do not stand for what comes through a body.
    if (gather_direct(x, segment.depth, branch, walk, surface, sum) && walk.passed && enter(walk)) {
      follow(transport().vertex(surface, walk), walk, branch, sum);
    }
    return sum;
  }

  Rgb gather_once(const Vertex& x, const Segment& segment, const Sampler&, std::uint64_t&,
                  Tally& tally) const override {
    assert(map_ != nullptr);
    tally.bounce();
    Rgb sum(0, 0, 0);
    // x itself is the last surface that a photon met, and the camera's path has counted it.
    const int most_depth = transport().settings().max_depth - segment.depth + 1;
    const float asked = transport().settings().photon_radius;
    const float wanted = (asked > 0 ? asked : kRadius * segment.distance) * shrunk_;
    const float radius = std::max(wanted, kLeastLength);
    map_->estimate(x, radius, most_depth, [&](const Photon& photon, const Rgb& radiance) {
      if (tally.wants_diffuse()) {
        tally.set_diffuse(x.bsdf.diffuse_share(x.local, x.frame.to_local(photon.direction)));
      }
      tally.add(photon.light, radiance);
      sum += radiance;
    });
    return sum;
  }

  std::shared_ptr<const PhotonMap> map_;
  float shrunk_;
};

}  // namespace

std::unique_ptr<Integrator> make_photon_integrator(const Scene& scene,
                                                   const IntegratorSettings& settings) {
  return std::make_unique<PhotonIntegrator>(std::make_shared<const LitScene>(scene, settings));
}

}  // namespace psf::render
