#include "run/pixel_features.h"

#include <algorithm>

namespace psf::run {
namespace {

// Adds to the three sums of a pixel.
template <class Three>
void add_three(std::vector<double>& sums, std::size_t pixel, const Three& value) {
  const std::size_t size = sums.size() / 3;
  sums[pixel] += double{value.x};
  sums[size + pixel] += double{value.y};
  sums[2 * size + pixel] += double{value.z};
}

std::vector<float> means(const std::vector<double>& sums, const std::vector<std::uint64_t>& of) {
  std::vector<float> values(sums.size());
  for (std::size_t k = 0; k < sums.size(); ++k) {
    const std::uint64_t count = of[k % of.size()];
    values[k] = count == 0 ? 0 : static_cast<float>(sums[k] / static_cast<double>(count));
  }
  return values;
}

}  // namespace

PixelFeatures::PixelFeatures(const filter::CameraView& camera)
    : width_(camera.width),
      height_(camera.height),
      paths_(width_ * height_),
      vertices_(width_ * height_),
      reflectance_(3 * width_ * height_),
      normal_(3 * width_ * height_),
      position_(3 * width_ * height_) {}

void PixelFeatures::add(const filter::Records& records, filter::Role role, std::size_t i) {
  const std::uint32_t pixel = records.pixel[i];
  ++paths_[pixel];
  if (!filter::is_query(role)) return;
  ++vertices_[pixel];
  add_three(position_, pixel, records.position[i]);
  if (!records.reflectance.empty() && is_finite(records.reflectance[i])) {
    add_three(reflectance_, pixel, records.reflectance[i]);
  }
  if (!records.normal.empty() && is_finite(records.normal[i])) {
    add_three(normal_, pixel, records.normal[i]);
  }
}

filter::PixelStatistics PixelFeatures::statistics() const {
  filter::PixelStatistics statistics;
  statistics.width = width_;
  statistics.height = height_;
  statistics.paths = paths_;
  statistics.vertices.resize(paths_.size());
  for (std::size_t pixel = 0; pixel < paths_.size(); ++pixel) {
    if (paths_[pixel] == 0) continue;
    statistics.vertices[pixel] = static_cast<float>(static_cast<double>(vertices_[pixel]) /
                                                    static_cast<double>(paths_[pixel]));
  }
  statistics.reflectance = means(reflectance_, paths_);
  statistics.normal = means(normal_, paths_);
  statistics.position = means(position_, vertices_);
  statistics.radiance.resize(3 * paths_.size());
  statistics.variance.resize(3 * paths_.size());
  return statistics;
}

void PixelFeatures::set_radiance(filter::PixelStatistics& statistics, std::size_t pixel,
                                 double paths, const double* sum, const double* squares) {
  if (paths <= 0) return;
  const std::size_t size = statistics.width * statistics.height;
  for (std::size_t c = 0; c < 3; ++c) {
    const double mean = sum[c] / paths;
    statistics.radiance[c * size + pixel] = static_cast<float>(mean);
    if (paths < 2) continue;
    statistics.variance[c * size + pixel] =
        static_cast<float>(std::max(0.0, squares[c] / paths - mean * mean) / (paths - 1));
  }
}

}  // namespace psf::run
