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
  // Of the statistics, with the number of paths, and what second_pass() needs beside them for so many
  // planes.
  [[nodiscard]] static constexpr std::uint64_t bytes_to_regress(std::uint64_t planes) {
    return 16 * sizeof(float) + sizeof(std::uint64_t) + filter::second_pass_bytes(planes);
  }

 private:
  std::size_t width_ = 0, height_ = 0;
  std::vector<std::uint64_t> paths_, vertices_;
  std::vector<double> reflectance_, normal_, position_;  // (3, height, width)
};

}  // namespace psf::run
