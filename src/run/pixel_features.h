// What the second pass [second] knows of a camera's pixels, as sums over their paths.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "filter/pixels/second_pass.h"
#include "filter/records.h"
#include "filter/roles.h"

namespace psf::run {

class PixelFeatures {
 public:
  PixelFeatures() = default;  // of a picture without second pass
  explicit PixelFeatures(const filter::CameraView& camera);

  // Adds path i, which is in the picture. Add the paths of a pixel from one thread, in path order.
  void add(const filter::Records& records, filter::Role role, std::size_t i);
  // Statistics with radiance and variance still 0.
  [[nodiscard]] filter::PixelStatistics statistics() const;
  // Sets radiance and variance of a pixel from the sums of the radiance of `paths` paths and of its
  // squares. One path alone has no variance.
  static void set_radiance(filter::PixelStatistics& statistics, std::size_t pixel, double paths,
                           const double* sum, const double* squares);

  [[nodiscard]] bool empty() const { return paths_.empty(); }

  static constexpr std::uint64_t kBytesAPixel = 9 * sizeof(double) + 2 * sizeof(std::uint64_t);
  // Statistics, and the images that second_pass() makes of them; a plane's image more.
  static constexpr std::uint64_t kBytesToRegress = (16 + 24) * sizeof(float);
  static constexpr std::uint64_t kBytesToRegressAPlane = 2 * sizeof(float);

 private:
  std::size_t width_ = 0, height_ = 0;
  std::vector<std::uint64_t> paths_, vertices_;
  std::vector<double> reflectance_, normal_, position_;  // (3, height, width)
};

}  // namespace psf::run
