#include "run/pictures.h"

#include <algorithm>
#include <numeric>

#include "core/parallel.h"
#include "film/relight.h"
#include "run/path_radiance.h"
#include "run/pixel_bands.h"

namespace psf::run {
namespace {

// Value i of a column that may be missing.
Rgb value_of(std::span<const Rgb> column, std::size_t i) {
  return column.empty() ? Rgb(0, 0, 0) : column[i];
}

}  // namespace

CameraPictures::CameraPictures(const filter::CameraView& camera, const PictureLayers& layers)
    : details_(camera.width, camera.height),
      layers_(layers),
      albedo_(layers.albedo ? camera.width : 0, layers.albedo ? camera.height : 0),
      normal_(layers.normal ? camera.width : 0, layers.normal ? camera.height : 0) {
  const film::Film empty(camera.width, camera.height);
  light_.push_back({"", empty, empty});
  if (!layers.light) return;
  for (const std::string& name : *layers.light) light_.push_back({name, empty, empty});
}

bool CameraPictures::add(const filter::Records& records, const filter::Estimates& estimates,
                         std::span<const float> radius, std::size_t i) {
  const filter::Role role = estimates.roles[i];
  if (role == filter::Role::left_out) return true;
  const auto radiance_of = [&](const Rgb& u, std::span<const Rgb> c,
                               std::span<const Rgb> c_bar) -> Radiance {
    if (!filter::is_query(role)) return {u, u};
    const Rgb& alpha = records.throughput[i];
    const Rgb filtered = path_radiance(u, alpha, value_of(c_bar, i));
    if (role != filter::Role::source) return {filtered, filtered};
    return {filtered, path_radiance(u, alpha, value_of(c, i))};
  };
  const auto of_layer = [&](std::size_t k) {
    const filter::Layer& layer = records.layers[k];
    return radiance_of(value_of(layer.unfiltered, i), layer.contribution, estimates.layers[k]);
  };
  const Radiance all =
      radiance_of(unfiltered_of(records, i), records.contribution, estimates.c_bar);
  bool finite = is_finite(all.filtered) && is_finite(all.input);
  for (std::size_t k = 0; k + 1 < light_.size(); ++k) {
    const Radiance layer = of_layer(k);
    finite = finite && is_finite(layer.filtered) && is_finite(layer.input);
  }
  if (!finite) return false;  // in every layer or in none, so that they add up

  const std::uint32_t pixel = records.pixel[i];
  add(light_[0], pixel, role, all);
  for (std::size_t k = 0; k + 1 < light_.size(); ++k) add(light_[k + 1], pixel, role, of_layer(k));
  const bool vertex = filter::is_query(role);
  if (vertex) {
    const float r_i = estimates.radius.empty() ? radius[i] : estimates.radius[i];
    details_.add(pixel, Rgb(static_cast<float>(estimates.neighbors[i]), r_i, 0));
  }
  add_guides(records, i, vertex);
  return true;
}

void CameraPictures::add(Light& light, std::uint32_t pixel, filter::Role role,
                         const Radiance& radiance) {
  light.filtered.add(pixel, radiance.filtered);
  if (filter::is_input(role)) light.unfiltered.add(pixel, radiance.input);
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

std::vector<float> CameraPictures::filled(const film::Film& unfiltered) const {
  std::vector<float> values = unfiltered.filled_mean();
  for (std::size_t pixel = 0; pixel < values.size() / 3; ++pixel) {
    if (!light_[0].filtered.has_path(pixel)) std::fill_n(&values[3 * pixel], 3, 0.0f);
  }
  return values;
}

film::Image CameraPictures::image() const {
  film::Image image;
  image.width = details_.width();
  image.height = details_.height();
  std::string names;
  for (const Light& light : light_) {
    if (!light.name.empty()) names += (names.empty() ? "" : ",") + light.name;
  }
  if (!names.empty()) image.attributes.emplace_back(film::kLightLayers, names);
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
  // Where a pixel has no path of its own, filled() takes those around.
  const bool has_holes = layers_.unfiltered && !light_[0].unfiltered.has_path_everywhere();
  for (const auto& [name, filtered, unfiltered] : light_) {
    const std::string prefix = name.empty() ? "" : name + ".";
    add(prefix, "RGB", filtered);
    if (layers_.unfiltered && !has_holes) add("unfiltered-input." + prefix, "RGB", unfiltered);
  }
  if (layers_.neighbors) add("neighbors.", "Y", details_, 0);
  if (layers_.radius) add("radius.", "Y", details_, 1);
  if (layers_.albedo) add("albedo.", "RGB", albedo_);
  if (layers_.normal) add("normal.", "XYZ", normal_);
  image.layers.resize(planes.size());
  core::parallel_for(planes.size(), 1, [&](std::size_t k, std::size_t) {
    image.layers[k] = {planes[k].channel, planes[k].film->mean(planes[k].component)};
  });
  if (has_holes) {
    for (const auto& [name, filtered, unfiltered] : light_) {
      image.add("unfiltered-input." + (name.empty() ? "" : name + "."), "RGB", filled(unfiltered));
    }
  }
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
