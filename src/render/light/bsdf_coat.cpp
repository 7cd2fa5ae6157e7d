// The coat's albedo table: quadrature over the distribution of visible normals.
#include "render/light/bsdf_coat.h"

#include <algorithm>

#include "core/parallel.h"
#include "render/light/microfacet.h"

namespace psf::render {

namespace {

template <class Fresnel>
float directional_albedo(float mu, float roughness, const Fresnel& fresnel) {
  const float alpha = roughness * roughness;
  if (alpha < kLeastAlpha) return fresnel(mu);
  constexpr int kSteps = 24;
  const Ggx ggx{alpha * alpha};
  const Vec3 o(std::sqrt(std::max(0.0f, 1 - mu * mu)), 0, mu);
  double sum = 0;
  for (int a = 0; a < kSteps; ++a) {
    for (int b = 0; b < kSteps; ++b) {
      // Half the azimuths: the other half mirrors them.
      const Vec2 u(0.5f * (static_cast<float>(a) + 0.5f) / kSteps,
                   (static_cast<float>(b) + 0.5f) / kSteps);
      const Vec3 h = ggx.sample(o, u), i = reflect(o, h);
      if (i.z <= 0) continue;
      sum += double{fresnel(std::min(1.0f, dot(o, h))) * ggx.g2(o, i) / ggx.g1(o)};
    }
  }
  return static_cast<float>(sum / (kSteps * kSteps));
}

float white_albedo(float mu, float roughness) {
  const float alpha = roughness * roughness;
  if (alpha < kLeastAlpha) return 1;
  constexpr int kAround = 12, kOut = 80;
  const Ggx ggx{alpha * alpha};
  const Vec3 o(std::sqrt(std::max(0.0f, 1 - mu * mu)), 0, mu);
  double sum = 0;
  for (int a = 0; a < kAround; ++a) {
    for (int b = 0; b < kOut; ++b) {
      // Dense where u.y is 1, and the normals are far from the surface's.
      const float t = (static_cast<float>(b) + 0.5f) / kOut;
      const Vec2 u(0.5f * (static_cast<float>(a) + 0.5f) / kAround, 1 - t * t);
      const Vec3 i = reflect(o, ggx.sample(o, u));
      if (i.z > 0) sum += 2 * double{t} * double{ggx.g2(o, i) / ggx.g1(o)};
    }
  }
  return static_cast<float>(std::min(1.0, sum / (kAround * kOut)));
}

}  // namespace

template <class Directional>
CoatAlbedo CoatAlbedo::tabulate(const Directional& directional) {
  CoatAlbedo albedo;
  core::parallel_for(kRoughnesses, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const float roughness = static_cast<float>(r) / (kRoughnesses - 1);
      for (std::size_t c = 0; c < kCosines; ++c) {
        // mu = 0 itself has no projected area: take the limit from just above.
        const float mu = std::max(1e-4f, static_cast<float>(c) / (kCosines - 1));
        albedo.table_[r][c] = directional(mu, roughness);
      }
      // 2 * integral of the piecewise linear E(mu) mu, exactly.
      double sum = 0;
      constexpr double kStep = 1.0 / (kCosines - 1);
      for (std::size_t c = 0; c + 1 < kCosines; ++c) {
        const double m0 = static_cast<double>(c) * kStep, e0 = double{albedo.table_[r][c]};
        const double de = double{albedo.table_[r][c + 1]} - e0;
        sum += 2 * kStep * (m0 * e0 + (m0 * de + kStep * e0) / 2 + kStep * de / 3);
      }
      albedo.mean_[r] = static_cast<float>(sum);
    }
  });
  return albedo;
}

CoatAlbedo::CoatAlbedo(float ior)
    : CoatAlbedo(tabulate([ior](float mu, float roughness) {
        return directional_albedo(mu, roughness,
                                  [ior](float cosine) { return fresnel_dielectric(cosine, ior); });
      })) {}

CoatAlbedo CoatAlbedo::schlick() {
  CoatAlbedo albedo = tabulate([](float mu, float roughness) {
    return directional_albedo(mu, roughness, [](float /*cosine*/) { return 1.0f; });
  });
  albedo.edge_ = std::make_shared<const CoatAlbedo>(tabulate([](float mu, float roughness) {
    return directional_albedo(mu, roughness,
                              [](float cosine) { return fresnel_schlick(Rgb(0), cosine).x; });
  }));
  return albedo;
}

CoatAlbedo CoatAlbedo::white() {
  return tabulate(white_albedo);
}

CoatAlbedo::Row CoatAlbedo::row(float roughness) const {
  const float x = std::clamp(roughness, 0.0f, 1.0f) * (kRoughnesses - 1);
  const auto r = std::min(static_cast<std::size_t>(x), std::size_t{kRoughnesses - 2});
  const float weight = x - static_cast<float>(r);
  return {table_[r].data(), table_[r + 1].data(), weight,
          mean_[r] + (mean_[r + 1] - mean_[r]) * weight};
}

float CoatAlbedo::Row::at(float mu) const {
  const float x = std::clamp(mu, 0.0f, 1.0f) * (kCosines - 1);
  const auto c = std::min(static_cast<std::size_t>(x), std::size_t{kCosines - 2});
  const float f = x - static_cast<float>(c);
  const float a = lower[c] + (lower[c + 1] - lower[c]) * f;
  const float b = upper[c] + (upper[c + 1] - upper[c]) * f;
  return a + (b - a) * weight;
}

}  // namespace psf::render
