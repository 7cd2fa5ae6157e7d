// The terms of w_ij: which there are, what each needs and what its threshold may be, in one table.
// How a term decides is in weights.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

namespace psf::filter {

enum class Term : std::uint8_t {
  normal,
  reflectance,
  visibility,
  hit_distance,
  plane,
  direction,
  material,
  gloss
};
inline constexpr std::size_t kTermCount = 8;

// A set of terms: bit k stands for the term of value k.
using TermSet = std::uint32_t;
[[nodiscard]] constexpr TermSet bit(Term term) {
  return TermSet{1} << static_cast<unsigned>(term);
}

// The terms of w_ij with their defaults; a threshold that is not set switches its term off.
struct WeightTerms {
  std::optional<float> normal = 0.95f;
  std::optional<float> reflectance = 0.05f;
  bool visibility = true;
  std::optional<float> hit_distance;
  std::optional<float> plane;
  std::optional<float> direction;
  bool material = false;
  std::optional<float> gloss = 0.8f;

  [[nodiscard]] static WeightTerms none();
  [[nodiscard]] bool on(Term term) const;
  void switch_off(Term term);
};

struct TermInfo {
  const char* name;       // of its parameter
  const char* condition;  // of a pair that passes, T is the threshold
  const char*
      apart;  // what tells a pair that it refuses, in words; "" where that is too much to say
  // Its member of WeightTerms: a threshold or a switch, the other is null.
  std::optional<float> WeightTerms::*threshold;
  bool WeightTerms::*is_on;
  // The channels it needs beside those that every dump has; "" where there is none.
  std::array<std::string_view, 3> channels;
  // The threshold T is in [least, most], and above `least` where it is `above`.
  float least = 0, most = std::numeric_limits<float>::infinity();
  bool above = false;
  const char* range = "the threshold must be >= 0";
};

// By the value of Term.
inline constexpr std::array<TermInfo, kTermCount> kTerms = {{
    {.name = "normal",
     .condition = "n_i . n_j >= T",
     .apart = "another normal",
     .threshold = &WeightTerms::normal,
     .is_on = nullptr,
     .channels = {"normal"},
     .least = -1,
     .most = 1,
     .range = "the threshold is a cosine in [-1, 1]"},
    {.name = "reflectance",
     .condition = "norm(rho_i - rho_j) <= T",
     .apart = "another reflectance",
     .threshold = &WeightTerms::reflectance,
     .is_on = nullptr,
     .channels = {"reflectance"}},
    {.name = "visibility",
     .condition = "the same lights are visible",
     .apart = "other lights seen",
     .threshold = nullptr,
     .is_on = &WeightTerms::visibility,
     .channels = {"visibility"}},
    {.name = "hit-distance",
     .condition = "first hits differ by at most T of the longer",
     .apart = "",
     .threshold = &WeightTerms::hit_distance,
     .is_on = nullptr,
     .channels = {"hit_distance"}},
    {.name = "plane",
     .condition = "at most T radii off the tangent plane",
     .apart = "off the tangent plane",
     .threshold = &WeightTerms::plane,
     .is_on = nullptr,
     .channels = {"normal"}},
    {.name = "direction",
     .condition = "directions to the camera: omega_i . omega_j >= T",
     .apart = "",
     .threshold = &WeightTerms::direction,
     .is_on = nullptr,
     .channels = {"direction"},
     .least = -1,
     .most = 1,
     .range = "the threshold is a cosine in [-1, 1]"},
    {.name = "material",
     .condition = "the same material",
     .apart = "another material",
     .threshold = nullptr,
     .is_on = &WeightTerms::material,
     .channels = {"material"}},
    {.name = "gloss",
     .condition = "on glossy surfaces: norm(n_i - n_j, 10 (omega_i - omega_j)) <= T roughness_i^2",
     .apart = "",
     .threshold = &WeightTerms::gloss,
     .is_on = nullptr,
     .channels = {"normal", "direction", "roughness"},
     .above = true,
     .range = "the threshold must be > 0"},
}};

[[nodiscard]] constexpr const TermInfo& info(Term term) {
  return kTerms[static_cast<std::size_t>(term)];
}

inline bool WeightTerms::on(Term term) const {
  const TermInfo& of = info(term);
  return of.threshold != nullptr ? (this->*of.threshold).has_value() : this->*of.is_on;
}

// The names alone.
inline constexpr std::array<const char*, kTermCount> kTermNames = [] {
  std::array<const char*, kTermCount> names{};
  for (std::size_t k = 0; k < kTermCount; ++k) names[k] = kTerms[k].name;
  return names;
}();

}  // namespace psf::filter
