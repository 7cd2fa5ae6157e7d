// The records of one block as the filter sees them: structure of arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/vec.h"

namespace psf::filter {

// Bits of `flags`, as in the file.
constexpr std::uint8_t kHasVertex = 1;
constexpr std::uint8_t kShaded = 2;

// Views of equal length; a channel that nothing needs may be empty. Symbols as in README.md.
struct Records {
  std::span<const std::uint8_t> flags;
  std::span<const Vec3> position;             // x_i, world units
  std::span<const float> distance;            // d_i, length of the camera segment, world units
  std::span<const Rgb> throughput;            // alpha_i
  std::span<const Rgb> contribution;          // c_i
  std::span<const Rgb> unfiltered;            // u_i
  std::span<const std::uint32_t> pixel;       // y * width + x
  std::span<const std::uint16_t> camera;      // index in Block::cameras; empty: all of camera 0
  std::span<const Vec3> normal;               // n_i, unit
  std::span<const Rgb> reflectance;           // rho_i
  std::span<const std::uint32_t> visibility;  // a bit a light
  std::span<const float> hit_distance;        // of the first ray shot from x_i; infinity: a miss
  std::span<const Vec3> direction;            // omega_i, unit, toward the camera
  std::span<const std::uint32_t> material;
  std::span<const float> roughness;  // perceptual, of the smoothest lobe; 1: diffuse

  [[nodiscard]] std::size_t size() const { return flags.size(); }
};

// What the filter needs to know of a camera.
struct CameraView {
  std::uint32_t width = 1, height = 1;  // pixels
  double angle_per_pixel = 0;           // radians
};

// Where a block of records lies in its dump.
struct Block {
  std::uint64_t first_path = 0;         // path number of record 0
  double n = 1;                         // of [radius]: samples per pixel or blocks up to its end
  double samples_per_pixel = 1;         // within the block, for the estimator `disk` alone
  std::span<const CameraView> cameras;  // at least one
  // Above 1: one path in so many is shaded, whatever it meets, and the flag kShaded of a record
  // without vertex says whether it was one of them.
  std::uint32_t shade_rate = 1;
};

}  // namespace psf::filter
