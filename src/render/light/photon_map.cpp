// Density estimation with photons (Jensen 1996, "Global Illumination Using Photon Maps").
#include "render/light/photon_map.h"

namespace psf::render {
namespace {

std::vector<Photon> trace_photons(const Transport& transport, const SamplerSettings& sampler,
                                  std::uint64_t pass, std::uint64_t& rays) {
  const IntegratorSettings& settings = transport.settings();
  const float scale = 1 / static_cast<float>(settings.photon_paths);
  const auto keep = [&](const LightVertex& v, std::vector<Photon>& photons) {
    const Bsdf& bsdf = v.at.bsdf;
    if (v.depth < 2 || bsdf.black() || bsdf.perfect()) return;
    if (bsdf.roughness() < settings.vertex_roughness) return;
    photons.push_back({v.at.surface.position, v.at.surface.geometric_normal, v.at.out,
                       v.power * scale, static_cast<std::uint32_t>(v.light), v.depth});
  };
  return LightPaths(transport).collect<Photon>(sampler, pass, settings.photon_paths, rays, keep);
}

std::vector<Vec3> positions(const std::vector<Photon>& photons) {
  std::vector<Vec3> result;
  result.reserve(photons.size());
  for (const Photon& photon : photons) result.push_back(photon.position);
  return result;
}

}  // namespace

PhotonMap::PhotonMap(const Transport& transport, const SamplerSettings& sampler, std::uint64_t pass,
                     std::uint64_t& rays)
    : photons_(trace_photons(transport, sampler, pass, rays)), index_(positions(photons_)) {}

void PhotonMap::estimate(const Vertex& x, float radius, int most_depth,
                         const std::function<void(const Photon&, const Rgb&)>& visit) const {
  std::vector<std::uint32_t> near;
  index_.within(x.surface.position, radius, near);
  const float per_area = 1 / (kPi * radius * radius);
  for (const std::uint32_t k : near) {
    const Photon& photon = photons_[k];
    const float cosine = dot(photon.direction, x.surface.geometric_normal);
    if (photon.depth > most_depth || !(cosine > 0)) continue;
    if (dot(photon.geometric_normal, x.surface.geometric_normal) < kTurned) continue;
    float no_pdf;
    const Rgb f = x.bsdf.evaluate(x.local, x.frame.to_local(photon.direction), no_pdf);
    // evaluate() is times the cosine, which power over area has in it already.
    if (!is_black(f)) visit(photon, f * photon.power * (per_area / cosine));
  }
}

}  // namespace psf::render
