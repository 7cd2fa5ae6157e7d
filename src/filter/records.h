// The records of one block as the filter sees them: structure of arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/vec.h"

namespace psf::filter {

// Views of equal length; a channel that nothing needs may be empty. Flags as in the file.
constexpr std::uint8_t kHasVertex = 1;
constexpr std::uint8_t kShaded = 2;

struct Records {
  std::span<const std::uint8_t> flags;
  std::span<const Vec3> position;        // x_i
  std::span<const float> distance;       // d_i
  std::span<const Rgb> throughput;       // alpha_i
  std::span<const Rgb> contribution;     // c_i
  std::span<const Rgb> unfiltered;       // u_i
  std::span<const std::uint32_t> pixel;  // y * width + x
  std::span<const std::uint16_t> camera;
  std::span<const Vec3> normal;          // n_i
  std::span<const Rgb> reflectance;      // rho_i
  std::span<const std::uint32_t> visibility;
  std::span<const float> hit_distance;
  std::span<const Vec3> direction;       // omega_i
  std::span<const std::uint32_t> material;

  [[nodiscard]] std::size_t size() const { return flags.size(); }
};

}  // namespace psf::filter
