// Weights and moments of the second pass for a tile of pixels.
#pragma once

#include <cstddef>
#include <vector>

namespace psf::filter::pixels {

constexpr std::size_t kReach = 6;  // pixels: the window is 13 x 13
constexpr std::size_t kPatch = 1;  // and a patch 3 x 3
// Two columns of a tile's vectors are those of patches beside it.
constexpr std::size_t kVectors = 32, kColumns = kVectors - 2 * kPatch, kRows = 16;
constexpr float kLikeness = 0.8f;     // k of [second]
constexpr float kMostNoise = 10'000;  // times V_p: V_q counts for no more
constexpr float kRidge = 1e-3f;
constexpr float kFarthest = 4;  // features of position are cut off here: 256 pixels away

// Images with a border, of copies of their outermost pixels or of 0, so that windows and patches
// need no other case.
class PaddedImages {
 public:
  PaddedImages(std::size_t width, std::size_t height, std::size_t images);

  [[nodiscard]] std::size_t stride() const { return stride_; }
  [[nodiscard]] float* image(std::size_t k) { return values_.data() + k * size_; }
  [[nodiscard]] const float* image(std::size_t k) const { return values_.data() + k * size_; }
  [[nodiscard]] std::size_t place(std::size_t x, std::size_t y) const {
    return (y + kBorder) * stride_ + x + kBorder;
  }
  // Copies the outermost pixels of an image into its border, which is 0 until then.
  void extend(std::size_t k);

 private:
  static constexpr std::size_t kBorder = kReach + kPatch;
  std::size_t width_, height_, stride_, size_;
  std::vector<float> values_;
};

// Which image is what.
struct Layout {
  std::size_t plane_count;  // the light in three colours, and what is to follow it

  static constexpr std::size_t kRadiance = 0,
                               kVariance = 3;     // three each, relative to the picture's
  static constexpr std::size_t kCounts = 6;       // 1 where a pixel counts; 0 elsewhere and outside
  static constexpr std::size_t kHasPosition = 7;  // 1 or 0
  static constexpr std::size_t kScale = 8;     // a difference of positions times this is a feature
  static constexpr std::size_t kFeatures = 9;  // reflectance, normal, vertices, position
  static constexpr std::size_t kFeatureCount = 10, kOfPosition = 7;  // the last three
  static constexpr std::size_t kPlanes = kFeatures + kFeatureCount;
};

// The fit of every plane at every pixel of a tile.
struct TileFit {
  std::vector<float> sums;  // moments of a tile; reused from tile to tile
  // (planes, kRows, kColumns): the weighted mean, and the constant of the fit.
  std::vector<double> mean, fit;
};

// `noise`: what is added to differences' variance, epsilon of [second].
void fit_tile(const PaddedImages& images, const Layout& layout, float noise, std::size_t x,
              std::size_t y, TileFit& tile);

}  // namespace psf::filter::pixels
