#include "run/pictures.h"

#include <algorithm>
#include <numeric>

#include "core/parallel.h"
#include "run/path_radiance.h"
#include "run/pixel_bands.h"

namespace psf::run {
CameraPictures::CameraPictures(const filter::CameraView& camera, const PictureLayers& layers)
    : filtered_(camera.width, camera.height),
      unfiltered_(camera.width, camera.height),
      details_(camera.width, camera.height),
      layers_(layers),
      albedo_(layers.albedo ? camera.width : 0, layers.albedo ? camera.height : 0),
      normal_(layers.normal ? camera.width : 0, layers.normal ? camera.height : 0) {}

bool CameraPictures::add(const filter::Records& records, const filter::Estimates& estimates,
                         std::span<const float> radius, std::size_t i) {
  const filter::Role role = estimates.roles[i];
  if (role == filter::Role::left_out) return true;
  const std::uint32_t pixel = records.pixel[i];
  const Rgb u = unfiltered_of(records, i);
  const bool vertex = filter::is_query(role);
  if (!vertex) {
    filtered_.add(pixel, u);
    if (filter::is_input(role)) unfiltered_.add(pixel, u);
  } else {
    const Rgb& alpha = records.throughput[i];
    const Rgb filtered = path_radiance(u, alpha, estimates.c_bar[i]);
    const bool source = role == filter::Role::source;
    const Rgb input = source ? path_radiance(u, alpha, records.contribution[i]) : filtered;
    if (!is_finite(filtered) || !is_finite(input)) return false;
    filtered_.add(pixel, filtered);
    if (source) unfiltered_.add(pixel, input);
    const float r_i = estimates.radius.empty() ? radius[i] : estimates.radius[i];
    details_.add(pixel, Rgb(static_cast<float>(estimates.neighbors[i]), r_i, 0));
  }
  add_guides(records, i, vertex);
  return true;
}

void CameraPictures::add_guides(const filter::Records& records, std::size_t i, bool vertex) {
  if (layers_.albedo) {
    const Rgb albedo = vertex ? records.reflectance[i] : Rgb(0, 0, 0);
    if (is_finite(albedo)) albedo_.add(records.pixel[i], albedo);
  }
  if (layers_.normal) {
    const Vec3 normal = vertex ? records.normal[i] : Vec3(0, 0, 0);
    if (is_finite(normal)) normal_.add(records.pixel[i], Rgb(normal.x, normal.y, normal.z));
  }
}

std::vector<float> CameraPictures::unfiltered() const {
  std::vector<float> values = unfiltered_.filled_mean();
  for (std::size_t pixel = 0; pixel < values.size() / 3; ++pixel) {
    if (!filtered_.has_path(pixel)) std::fill_n(&values[3 * pixel], 3, 0.0f);
  }
  return values;
}

film::Image CameraPictures::image() const {
  film::Image image;
  image.width = filtered_.width();
  image.height = filtered_.height();
  struct Plane {
    std::string channel;
    const film::Film* film;
    std::size_t component;
  };
  std::vector<Plane> planes;
  const auto add = [&](const std::string& prefix, const std::string& suffixes,
                       const film::Film& film, std::size_t first = 0) {
    for (std::size_t k = 0; k < suffixes.size(); ++k) {
      planes.push_back({prefix + suffixes[k], &film, first + k});
    }
  };
  // Where a pixel has no path of its own, unfiltered() takes those around.
  const bool has_holes = layers_.unfiltered && !unfiltered_.has_path_everywhere();
  add("", "RGB", filtered_);
  if (layers_.unfiltered && !has_holes) add("unfiltered-input.", "RGB", unfiltered_);
  if (layers_.neighbors) add("neighbors.", "Y", details_, 0);
  if (layers_.radius) add("radius.", "Y", details_, 1);
  if (layers_.albedo) add("albedo.", "RGB", albedo_);
  if (layers_.normal) add("normal.", "XYZ", normal_);
  image.layers.resize(planes.size());
  core::parallel_for(planes.size(), 1, [&](std::size_t k, std::size_t) {
    image.layers[k] = {planes[k].channel, planes[k].film->mean(planes[k].component)};
  });
  if (has_holes) image.add("unfiltered-input.", "RGB", unfiltered());
  return image;
}

std::uint64_t add_records(const filter::Records& records, const filter::Estimates& estimates,
                          std::span<const float> radius, std::size_t first, std::size_t last,
                          std::span<CameraPictures> pictures) {
  std::vector<std::uint64_t> overflows(pixel_bands(), 0);
  for_each_by_pixel(records, first, last, [&](std::size_t band, std::size_t i) {
    const std::size_t camera = records.camera.empty() ? 0 : records.camera[i];
    if (!pictures[camera].add(records, estimates, radius, i)) ++overflows[band];
  });
  return std::accumulate(overflows.begin(), overflows.end(), std::uint64_t{0});
}

}  // namespace psf::run
