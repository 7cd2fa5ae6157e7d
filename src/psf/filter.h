// Filters records that are in memory: no file.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "psf/error.h"
#include "psf/export.h"
#include "psf/parameters.h"
#include "psf/picture.h"

namespace psf {

// A camera that paths were traced from.
struct Camera {
  std::string name;            // in names of files where there are several
  std::uint32_t width = 1;     // pixels
  std::uint32_t height = 1;    // pixels
  double angle_per_pixel = 0;  // radians; for radii in pixels
};

// Views of n records, which are one block: a record a path, in path order. The first four are
// needed, the others may be empty. formats/README.md, "Channels", has the exact meaning of each.
struct Records {
  std::span<const float> position;       // (n, 3), x_i, world units
  std::span<const float> throughput;     // (n, 3), alpha_i
  std::span<const float> contribution;   // (n, 3), c_i, radiance
  std::span<const std::uint32_t> pixel;  // (n), y * width + x

  std::span<const float> distance;            // (n), world units; needed unless r0 is in them too
  std::span<const float> unfiltered;          // (n, 3), u_i, radiance
  std::span<const float> normal;              // (n, 3), unit
  std::span<const float> reflectance;         // (n, 3), albedo
  std::span<const float> direction;           // (n, 3), unit, toward the camera
  std::span<const float> hit_distance;        // (n), of the first ray from x_i, world units
  std::span<const float> roughness;           // (n), in [0, 1]
  std::span<const std::uint32_t> visibility;  // (n), a bit a light
  std::span<const std::uint32_t> material;    // (n), any numbers
  std::span<const std::uint16_t> camera;      // (n); empty: the first
  std::span<const std::uint8_t> flags;        // (n); empty: 3, with vertex and shaded
  std::span<const std::uint8_t> kind;         // (n), 0 surface, 1 curve, 2 volume; empty: 0
};

// What became of n records, and the pictures of their cameras.
struct FilteredRecords {
  std::vector<float> c_bar;              // (n, 3); 0 for a record without average
  std::vector<std::uint32_t> neighbors;  // (n); number of records averaged
  std::vector<float> radius;             // (n), world units
  std::vector<Picture> pictures;         // one a camera, with the layers of psf filter
};

// Filters one block. `n`: samples per pixel accumulated up to its end, for radii that shrink; 0:
// those of the records. The result is the same for any number of threads. Throws Error{usage} for
// columns of different lengths, Error{bad_input} for a channel that is missing, a pixel or camera
// that does not exist, and Error{interrupted}.
[[nodiscard]] PSF_API FilteredRecords filter_records(const Records& records,
                                                     std::span<const Camera> cameras,
                                                     const Parameters& parameters = {},
                                                     double n = 0);

}  // namespace psf
