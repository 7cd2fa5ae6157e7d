// The records of one block as the filter sees them: structure of arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/vec.h"

namespace psf::filter {

// The value of `kind` of a vertex in a volume; every other is of a surface or a curve.
constexpr std::uint8_t kVolume = 2;

// Which of the vertices a run takes, where those in volumes are filtered apart: README.md, "Kinds".
enum class Taken : std::uint8_t { all, surfaces, volumes };

// Bits of `flags`, as in the file.
constexpr std::uint8_t kHasVertex = 1;
constexpr std::uint8_t kShaded = 2;

// A named part of the light of every path: parts of c_i and of u_i, finite. All layers of a file
// add up to c_i and u_i.
struct Layer {
  std::span<const Rgb> contribution;  // c_i^l; empty: 0
  std::span<const Rgb> unfiltered;    // u_i^l; empty: 0
};

// Vertices of paths from the lights, of all passes that a block overlaps: what [density] adds up.
// Views of equal length.
struct Photons {
  std::span<const Vec3> position;   // x_p, world units
  std::span<const Vec3> normal;     // n_p, unit, on the side of the light
  std::span<const Vec3> direction;  // omega_p, unit, toward where the light came from
  std::span<const Rgb> power;       // Phi_p, flux over the number of light paths of its pass
  std::span<const std::uint32_t> material;  // empty where nothing compares it
  std::uint32_t passes = 0;                 // P; 0: nobody has looked for photons
};

// Views of equal length; a channel that nothing needs may be empty. The symbols are those of
// README.md.
struct Records {
  std::span<const std::uint8_t> flags;
  std::span<const Vec3> position;             // x_i, world units
  std::span<const float> distance;            // d_i, length of the camera segment, world units
  std::span<const Rgb> throughput;            // alpha_i
  std::span<const Rgb> contribution;          // c_i
  std::span<const Rgb> unfiltered;            // u_i
  std::span<const std::uint32_t> pixel;       // y * width + x
  std::span<const std::uint16_t> camera;      // index in Block::cameras; empty: camera 0 for all
  std::span<const Vec3> normal;               // n_i, unit
  std::span<const Rgb> reflectance;           // rho_i
  std::span<const std::uint32_t> visibility;  // one bit per light
  std::span<const float> hit_distance;        // h_i, of the first ray from x_i; infinity: a miss
  std::span<const Vec3> direction;            // omega_i, unit, toward the camera
  std::span<const std::uint32_t> material;
  std::span<const float> roughness;          // q_i, perceptual, of the smoothest lobe; 1: diffuse
  std::span<const float> coverage = {};      // 0: the path is of the background; for pictures
  std::span<const Layer> layers = {};        // averaged beside c_i, with the same weights
  Photons photons = {};                      // not of the records' number
  std::span<const std::uint8_t> kind = {};   // what x_i lies on; empty: surfaces and curves alone
  Taken taken = Taken::all;                  // the other vertices have no part
  std::span<const Vec3> rest_position = {};  // x_i at frame 0: for windows of frames

  [[nodiscard]] std::size_t size() const { return flags.size(); }
  [[nodiscard]] bool in_volume(std::size_t i) const { return !kind.empty() && kind[i] == kVolume; }
  // Whether record i, which has a vertex, is one of `taken`.
  [[nodiscard]] bool takes(std::size_t i) const {
    return taken == Taken::all || in_volume(i) == (taken == Taken::volumes);
  }
};

// The properties of a camera that the filter uses.
struct CameraView {
  std::uint32_t width = 1, height = 1;  // pixels
  double angle_per_pixel = 0;           // radians
};

// Where a block of records lies in its dump.
struct Block {
  std::uint64_t first_path = 0;         // path number of record 0
  double n = 1;                         // [radius]: samples per pixel, or blocks, up to its end
  double samples_per_pixel = 1;         // within the block
  std::span<const CameraView> cameras;  // at least one
  // Above 1: one path in `shade_rate` is shaded, whatever it meets, and the flag kShaded of a
  // record without vertex says whether its path is one of these.
  std::uint32_t shade_rate = 1;
};

}  // namespace psf::filter
