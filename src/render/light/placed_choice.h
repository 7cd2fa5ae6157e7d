// Which of many lights is sampled from a place: near ones by a tree, those at infinity by what they
// bring to a surface that faces as it does there.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "render/light/light_tree.h"

namespace psf::render {

class PlacedChoice {
 public:
  // A light at infinity.
  struct Distant {
    std::size_t light;
    Vec3 direction;    // unit, toward it; 0: it comes from everywhere
    float cos_radius;  // of its angular radius
    float irradiance;  // on a surface that faces it, in the unit of the intensities over lengths^2
  };

  PlacedChoice(LightTree near, std::vector<Distant> far)
      : near_(std::move(near)), far_(std::move(far)) {}

  // A light whose number is that in the tree or of Distant; where `probability` is 0 no light
  // arrives.
  [[nodiscard]] std::size_t choose(const Receiver& at, float u, float& probability) const;
  // The probability with which choose() chooses it.
  [[nodiscard]] float probability(const Receiver& at, std::size_t light) const;

  // How the lights are sampled where more than one is: each that is likely to bring at least this
  // share of the light once, and one of the others.
  static constexpr float kStrong = 0.125f;
  struct Plan {
    std::array<std::size_t, 8> strong{};  // lights
    std::size_t count = 0;                // of these
    LightTree::Cut others;                // near ones
    float floor = 0;                      // no cluster and no light of the others weighs less
    float rest = 0;                       // weight of all others
    [[nodiscard]] bool is_strong(std::size_t light) const {
      return std::find(strong.begin(), strong.begin() + static_cast<std::ptrdiff_t>(count),
                       light) != strong.begin() + static_cast<std::ptrdiff_t>(count);
    }
  };
  [[nodiscard]] Plan plan(const Receiver& at) const;
  // One of the others; as for choose().
  [[nodiscard]] std::size_t choose_rest(const Receiver& at, const Plan& plan, float u,
                                        float& probability) const;
  // How many samples of it a plan has on the average.
  [[nodiscard]] float expected(const Receiver& at, std::size_t light) const;

 private:
  [[nodiscard]] float irradiance(const Receiver& at, const Distant& light) const;
  // The probability of the tree; sets `far` to the sum of what comes from infinity. Below 0 where no
  // light arrives at all.
  [[nodiscard]] float near_share(const Receiver& at, float& far) const;

  LightTree near_;
  std::vector<Distant> far_;
};

}  // namespace psf::render
