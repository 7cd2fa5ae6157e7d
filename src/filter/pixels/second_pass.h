// The second pass: every pixel of a picture of filtered paths by a linear fit over the pixels around
// it that can have the same mean; [second] in README.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace psf::filter {

// What the paths of each pixel have told. Images are (height, width), row 0 at the top; those of
// three components are three images, one behind the other.
struct PixelStatistics {
  std::size_t width = 0, height = 0;
  std::vector<std::uint64_t> paths;  // of the pixel; one without paths stays what it is
  // The mean radiance of the filtered paths and the variance of this mean, (3, height, width).
  std::vector<float> radiance, variance;
  std::vector<float> vertices;  // the share of the paths that have a vertex
  // (3, height, width). Means over all paths, where those without vertex count as 0; what is not
  // known is 0 everywhere.
  std::vector<float> reflectance, normal;
  std::vector<float> position;  // (3, height, width), means over the paths with a vertex
};

// What is replaced: an image that is a part of the light in one colour, or some other mean over the
// paths of a pixel.
struct PixelPlane {
  std::span<float> values;        // (height, width)
  std::size_t colour = kNoLight;  // 0, 1, 2

  static constexpr std::size_t kNoLight = 3;
};

// Replaces the values of each plane by those of the fit. Which pixels count, and how much, is the
// same for all planes, so parts of the light still add up to the whole; where the fit of
// `statistics.radiance` is below 0, each part goes the same way back to its weighted mean that
// brings the whole to 0, but for rounding. The same for any number of threads and any instruction
// set. Pixels whose radiance or variance is not finite, or above 1e15 times the picture's, stay as
// they are and count nowhere. Radiances should be between 1e-19 and 1e19, whose squares are floats.
void second_pass(const PixelStatistics& statistics, std::span<const PixelPlane> planes);

// The bytes a pixel that second_pass() takes for so many planes: an image of each, of the light, and
// of 19 more, with borders that are a fourth more at 300 pixels a side, and less in larger pictures.
[[nodiscard]] constexpr std::uint64_t second_pass_bytes(std::uint64_t planes) {
  return (planes + 22) * sizeof(float) * 5 / 4;
}

}  // namespace psf::filter
