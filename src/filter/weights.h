// w_ij: whether c_j could have been generated at x_i. This is the only definition of every term, in
// float and in this order of operations; every search and every kernel must decide as it does.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "filter/parameters/parameters.h"
#include "filter/records.h"
#include "search/ball.h"

namespace psf::filter {

[[nodiscard]] inline bool normal_term(const Vec3& n_i, const Vec3& n_j, float t) {
  return dot(n_i, n_j) >= t;
}
[[nodiscard]] inline bool reflectance_term(const Rgb& rho_i, const Rgb& rho_j, float t_sq) {
  return search::distance_sq(rho_i, rho_j) <= t_sq;
}
[[nodiscard]] inline bool visibility_term(std::uint32_t bits_i, std::uint32_t bits_j) {
  return bits_i == bits_j;
}
// Whether the difference is at most t times the longer distance. A miss (infinity) passes with
// another miss alone.
[[nodiscard]] inline bool hit_distance_term(float h_i, float h_j, float t) {
  const float longer = h_i < h_j ? h_j : h_i;
  return h_i == h_j || (std::abs(h_i - h_j) <= t * longer && std::isfinite(longer));
}
[[nodiscard]] inline bool plane_term(const Vec3& x_i, const Vec3& n_i, const Vec3& x_j, float t,
                                     float r_i) {
  const Vec3 to_j(x_j.x - x_i.x, x_j.y - x_i.y, x_j.z - x_i.z);
  return std::abs(dot(to_j, n_i)) <= t * r_i;
}
[[nodiscard]] inline bool direction_term(const Vec3& omega_i, const Vec3& omega_j, float t) {
  return dot(omega_i, omega_j) >= t;
}
[[nodiscard]] inline bool material_term(std::uint32_t m_i, std::uint32_t m_j) {
  return m_i == m_j;
}

// alpha of GGX: about the angle in radians by which the microfacets of a glossy lobe turn away from
// n. Infinite where there is no glossy lobe, so that directions do not matter.
[[nodiscard]] inline float lobe_width(float roughness) {
  return roughness < 1 ? roughness * roughness : std::numeric_limits<float>::infinity();
}
// The weight of the squared distance of directions in gloss_term(). It is large because directions
// turn where x moves, and then near objects move in the mirror by much more than the direction.
inline constexpr float kDirectionWeight = 100;
// Whether the normals and the weighted directions together differ by at most t > 0 times the lobe
// width of x_i.
[[nodiscard]] inline bool gloss_term(const Vec3& n_i, const Vec3& n_j, const Vec3& omega_i,
                                     const Vec3& omega_j, float width_i, float t) {
  const float reach = t * width_i;
  return search::distance_sq(n_i, n_j) + kDirectionWeight * search::distance_sq(omega_i, omega_j) <=
         reach * reach;
}

// The product of the terms that are on. w_ii is 1 whatever the terms say, so callers do not test
// the pair (i, i).
class Weights {
 public:
  Weights(const Records& records, const WeightTerms& terms)
      : r_(records),
        on_(terms),
        reflectance_sq_(terms.reflectance.value_or(0) * terms.reflectance.value_or(0)) {}

  [[nodiscard]] const WeightTerms& terms() const { return on_; }

  [[nodiscard]] bool pass(std::uint32_t i, std::uint32_t j, float r_i) const {
    return !refuses_normal(i, j) && !refuses_reflectance(i, j) && !refuses_visibility(i, j) &&
           !refuses_hit_distance(i, j) && !refuses_plane(i, j, r_i) && !refuses_direction(i, j) &&
           !refuses_material(i, j) && !refuses_gloss(i, j);
  }
  // The terms that refuse the pair, each by itself: bit k is set where term k refuses. It is 0
  // exactly where pass() is true.
  [[nodiscard]] std::uint32_t refusers(std::uint32_t i, std::uint32_t j, float r_i) const {
    const bool by[kTermCount] = {refuses_normal(i, j),     refuses_reflectance(i, j),
                                 refuses_visibility(i, j), refuses_hit_distance(i, j),
                                 refuses_plane(i, j, r_i), refuses_direction(i, j),
                                 refuses_material(i, j),   refuses_gloss(i, j)};
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < kTermCount; ++k) bits |= std::uint32_t{by[k]} << k;
    return bits;
  }

 private:
  [[nodiscard]] bool refuses_normal(std::uint32_t i, std::uint32_t j) const {
    return on_.normal && !normal_term(r_.normal[i], r_.normal[j], *on_.normal);
  }
  [[nodiscard]] bool refuses_reflectance(std::uint32_t i, std::uint32_t j) const {
    return on_.reflectance &&
           !reflectance_term(r_.reflectance[i], r_.reflectance[j], reflectance_sq_);
  }
  [[nodiscard]] bool refuses_visibility(std::uint32_t i, std::uint32_t j) const {
    return on_.visibility && !visibility_term(r_.visibility[i], r_.visibility[j]);
  }
  [[nodiscard]] bool refuses_hit_distance(std::uint32_t i, std::uint32_t j) const {
    return on_.hit_distance &&
           !hit_distance_term(r_.hit_distance[i], r_.hit_distance[j], *on_.hit_distance);
  }
  [[nodiscard]] bool refuses_plane(std::uint32_t i, std::uint32_t j, float r_i) const {
    return on_.plane && !plane_term(r_.position[i], r_.normal[i], r_.position[j], *on_.plane, r_i);
  }
  [[nodiscard]] bool refuses_direction(std::uint32_t i, std::uint32_t j) const {
    return on_.direction && !direction_term(r_.direction[i], r_.direction[j], *on_.direction);
  }
  [[nodiscard]] bool refuses_material(std::uint32_t i, std::uint32_t j) const {
    return on_.material && !material_term(r_.material[i], r_.material[j]);
  }
  [[nodiscard]] bool refuses_gloss(std::uint32_t i, std::uint32_t j) const {
    return on_.gloss && !gloss_term(r_.normal[i], r_.normal[j], r_.direction[i], r_.direction[j],
                                    lobe_width(r_.roughness[i]), *on_.gloss);
  }

  Records r_;
  WeightTerms on_;
  float reflectance_sq_;
};

}  // namespace psf::filter
