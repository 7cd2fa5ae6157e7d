#include "study/metrics/error_picture.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <vector>

#include "core/error.h"
#include "core/output_file.h"
#include "film/display.h"
#include "film/image.h"

namespace psf::study {
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
  const auto width = static_cast<int>(errors.width()), height = static_cast<int>(errors.height());
  OIIO::ImageBuf scaled(OIIO::ImageSpec(width, height, 1, OIIO::TypeDesc::FLOAT));
  const auto for_pixels = [&](const auto& body) {
    for (std::size_t i = 0; i < map.size(); ++i) {
      body(i, static_cast<int>(i % errors.width()), static_cast<int>(i / errors.width()));
    }
  };
  for_pixels([&](std::size_t i, int x, int y) {
    const float value[1] = {static_cast<float>(std::min(map[i] / max, 1.0))};
    scaled.setpixel(x, y, value);
  });
  // OpenImageIO gives the colours of the map in linear light.
  OIIO::ImageBuf picture = OIIO::ImageBufAlgo::color_map(scaled, 0, color_map);
  if (picture.has_error()) throw Error(ErrorCode::usage, path + ": " + picture.geterror());
  for_pixels([&](std::size_t i, int x, int y) {
    float color[3] = {0, 1, 1};
    if (errors.non_finite()[i] == 0) {
      for (int k = 0; k < 3; ++k) color[k] = film::srgb_from_linear(picture.getchannel(x, y, 0, k));
    }
    picture.setpixel(x, y, color);
  });
  picture.specmod().attribute("oiio:ColorSpace", "sRGB");
  core::OutputFile file(path);
  if (!picture.write(file.temporary_path(), OIIO::TypeDesc::UINT8, "png")) {
    throw Error(ErrorCode::io, path + ": cannot write the picture: " + picture.geterror());
  }
  file.commit();
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

}  // namespace psf::study
