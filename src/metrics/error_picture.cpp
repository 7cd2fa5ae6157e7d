#include "metrics/error_picture.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <vector>

#include "core/error.h"
#include "film/image.h"

namespace psf::metrics {
namespace {

void write_values(const std::string& path, const Errors& errors, Metric metric,
                  const MetricOptions& options) {
  const std::span<const double> map = errors.map(metric);
  std::vector<float> values(map.begin(), map.end());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (errors.non_finite()[i] != 0) values[i] = std::numeric_limits<float>::quiet_NaN();
  }
  film::Image image;
  image.width = errors.width();
  image.height = errors.height();
  image.add("", "Y", values);
  image.attributes = {{"psf:metric", error_name(metric)},
                      {"psf:settings", settings(metric, options)}};
  film::write_exr(path, image);
}

void write_colors(const std::string& path, const Errors& errors, Metric metric, double max,
                  const std::string& color_map) {
  const std::span<const double> map = errors.map(metric);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(3 * map.size());
  for (std::size_t i = 0; i < map.size(); ++i) {
    std::array<std::uint8_t, 3> color = {0, 255, 255};
    if (errors.non_finite()[i] == 0) color = mapped_color(color_map, map[i] / max);
    bytes.insert(bytes.end(), color.begin(), color.end());
  }
  film::write_png_bytes(path, errors.width(), errors.height(), bytes);
}

}  // namespace

const char* error_name(Metric metric) {
  switch (metric) {
    case Metric::psnr:
      return "MSE";
    case Metric::ssim:
      return "1 - SSIM";
    default:
      return name(metric);
  }
}

ErrorScale error_scale(const Errors& errors, Metric metric, double max) {
  constexpr double kShown = 0.99;
  std::vector<double> finite;
  const std::span<const double> map = errors.map(metric);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (errors.non_finite()[i] == 0) finite.push_back(map[i]);
  }
  ErrorScale scale;
  scale.max = max > 0 ? max : 1;
  if (max <= 0 && !finite.empty()) {
    const auto place = finite.begin() +
                       static_cast<std::ptrdiff_t>(kShown * static_cast<double>(finite.size() - 1));
    std::nth_element(finite.begin(), place, finite.end());
    if (*place > 0) scale.max = *place;
  }
  scale.above = static_cast<std::size_t>(
      std::count_if(finite.begin(), finite.end(), [&](double error) { return error > scale.max; }));
  return scale;
}

void write_error_picture(const std::string& path, const Errors& errors, Metric metric,
                         const MetricOptions& options, const ErrorScale& scale,
                         const std::string& color_map) {
  film::check_image_path(path);
  if (std::filesystem::path(path).extension() == ".exr") {
    write_values(path, errors, metric, options);
  } else {
    write_colors(path, errors, metric, scale.max, color_map);
  }
}

}  // namespace psf::metrics
