#include "run/pictures.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "film/light_layers.h"
#include "run/path_radiance.h"
#include "run/pixel_bands.h"

namespace psf::run {
namespace {

using filter::Estimates;
using filter::Records;
using filter::Role;

// Of the light, or of a layer of it.
struct Part {
  std::span<const Rgb> u, c, c_bar;  // of the records; empty: 0
};

Part whole_of(const Records& records, const Estimates& estimates) {
  return {records.unfiltered, records.contribution, estimates.c_bar};
}
Part layer_of(const Records& records, const Estimates& estimates, std::size_t k) {
  const filter::Layer& layer = records.layers[k];
  return {layer.unfiltered, layer.contribution, estimates.layers[k]};
}

// What a path adds to the filtered picture, and to the picture without filter.
struct Radiance {
  Rgb filtered, input;
  // One test for six: 0 times what is not finite is NaN.
  [[nodiscard]] bool finite() const {
    return (filtered.x * 0 + filtered.y * 0) + (filtered.z * 0 + input.x * 0) +
               (input.y * 0 + input.z * 0) ==
           0;
  }
};

// Inline, since it is there once for every record and layer.
[[gnu::always_inline]] inline Radiance radiance_of(const Part& part, const Rgb& alpha, Role role,
                                                   std::size_t i) {
  const auto value = [i](std::span<const Rgb> column) {
    return column.empty() ? Rgb(0, 0, 0) : column[i];
  };
  const Rgb u = value(part.u);
  if (!filter::is_query(role)) return {u, u};
  const Rgb filtered = path_radiance(u, alpha, value(part.c_bar));
  if (role != Role::source) return {filtered, filtered};
  return {filtered, path_radiance(u, alpha, value(part.c))};
}

// Sets `kept` to those of `some` records that are in the pictures: not left out, and finite.
// Returns how many overflow.
std::uint64_t keep(const Records& records, const Estimates& estimates,
                   std::span<const std::size_t> some, std::vector<std::size_t>& kept) {
  const Part whole = whole_of(records, estimates);
  std::uint64_t overflows = 0;
  kept.clear();
  for (const std::size_t i : some) {
    const Role role = estimates.roles[i];
    if (role == Role::left_out) continue;
    if (radiance_of(whole, records.throughput[i], role, i).finite()) {
      kept.push_back(i);
    } else {
      ++overflows;
    }
  }
  return overflows;
}

// A channel of a picture.
struct Plane {
  std::string name;
  const film::Film* film;
  std::size_t component;
  std::optional<std::size_t> colour;  // as which the second pass takes it; not set: it stays
};

// The second pass over those of the image's first layers, one for each plane, that it is for.
void regress(const filter::PixelStatistics& statistics, std::span<const Plane> planes,
             film::Image& image) {
  std::vector<filter::PixelPlane> regressed;
  for (std::size_t k = 0; k < planes.size(); ++k) {
    if (planes[k].colour) regressed.push_back({image.layers[k].values, *planes[k].colour});
  }
  filter::second_pass(statistics, regressed);
  for (const filter::PixelPlane& plane : regressed) {
    if (plane.colour != filter::PixelPlane::kNoLight) continue;  // else it is alpha
    for (float& value : plane.values) value = std::clamp(value, 0.0f, 1.0f);
  }
}

}  // namespace

CameraPictures::CameraPictures(const filter::CameraView& camera, const PictureLayers& layers,
                               filter::PixelRule rule)
    : layer_names_(layers.light.value_or(std::vector<std::string>())),
      filtered_(camera.width, camera.height, 1 + layer_names_.size() + (layers.alpha ? 1 : 0)),
      unfiltered_(camera.width, camera.height, 1 + layer_names_.size() + (layers.alpha ? 1 : 0)),
      details_(camera.width, camera.height),
      layers_(layers),
      albedo_(layers.albedo ? camera.width : 0, layers.albedo ? camera.height : 0),
      normal_(layers.normal ? camera.width : 0, layers.normal ? camera.height : 0),
      alpha_(layers.alpha ? camera.width : 0, layers.alpha ? camera.height : 0),
      fireflies_(layers.fireflies ? camera.width : 0, layers.fireflies ? camera.height : 0) {
  if (rule == filter::PixelRule::keep) return;
  features_ = PixelFeatures(camera);
  moments_.resize(6 * std::size_t{camera.width} * camera.height);
}

void CameraPictures::add(const Records& records, const Estimates& estimates,
                         std::span<const float> radius, std::size_t i) {
  const Role role = estimates.roles[i];
  const std::uint32_t pixel = records.pixel[i];
  const Radiance radiance =
      radiance_of(whole_of(records, estimates), records.throughput[i], role, i);
  const std::size_t part = is_background(records, i) ? 1 + layer_names_.size() : 0;
  filtered_.count(pixel);
  filtered_.add_part(part, pixel, radiance.filtered);
  if (filter::is_input(role)) {
    unfiltered_.count(pixel);
    unfiltered_.add_part(part, pixel, radiance.input);
  }
  const bool vertex = filter::is_query(role);
  if (vertex) {
    const float r_i = estimates.radius.empty() ? radius[i] : estimates.radius[i];
    details_.add(pixel, Rgb(static_cast<float>(estimates.neighbors[i]), r_i, 0));
  }
  add_guides(records, i, vertex);
  add_fireflies(records, estimates, i, vertex);
  add_to_features(records, role, radiance.filtered, i);
}

void CameraPictures::add_layer(std::size_t k, const Records& records, const Estimates& estimates,
                               std::span<const std::size_t> some,
                               std::span<CameraPictures> pictures) {
  const Part layer = layer_of(records, estimates, k);
  if (layer.u.empty() && layer.c.empty()) return;  // black
  for (const std::size_t i : some) {
    CameraPictures& picture = pictures[records.camera.empty() ? 0 : records.camera[i]];
    if (picture.is_background(records, i)) continue;  // it is in the background as a whole
    const Role role = estimates.roles[i];
    const std::uint32_t pixel = records.pixel[i];
    const Radiance radiance = radiance_of(layer, records.throughput[i], role, i);
    if (!radiance.finite()) continue;
    picture.filtered_.add_part(k + 1, pixel, radiance.filtered);
    if (filter::is_input(role)) picture.unfiltered_.add_part(k + 1, pixel, radiance.input);
  }
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
  if (layers_.alpha) alpha_.add(records.pixel[i], Rgb(records.coverage[i], 0, 0));
}

void CameraPictures::add_fireflies(const Records& records, const Estimates& estimates,
                                   std::size_t i, bool vertex) {
  if (!layers_.fireflies) return;
  const bool spread = vertex && !estimates.given.empty();
  const Rgb light = spread ? records.throughput[i] * estimates.given[i] : Rgb(0, 0, 0);
  if (is_finite(light)) fireflies_.add(records.pixel[i], light);
}

void CameraPictures::add_to_features(const Records& records, Role role, const Rgb& radiance,
                                     std::size_t i) {
  if (features_.empty()) return;
  features_.add(records, role, i);
  double* moments = &moments_[6 * std::size_t{records.pixel[i]}];
  for (int c = 0; c < 3; ++c) {
    moments[c] += double{radiance[c]};
    moments[3 + c] += double{radiance[c]} * double{radiance[c]};
  }
}

filter::PixelStatistics CameraPictures::statistics() const {
  filter::PixelStatistics statistics = features_.statistics();
  for (std::size_t pixel = 0; pixel < statistics.paths.size(); ++pixel) {
    const double* moments = &moments_[6 * pixel];
    PixelFeatures::set_radiance(statistics, pixel, static_cast<double>(statistics.paths[pixel]),
                                moments, moments + 3);
  }
  return statistics;
}

std::vector<float> CameraPictures::filled(std::size_t part) const {
  std::vector<float> values = unfiltered_.filled_mean(part);
  for (std::size_t pixel = 0; pixel < values.size() / 3; ++pixel) {
    if (!filtered_.has_path(pixel)) std::fill_n(&values[3 * pixel], 3, 0.0f);
  }
  return values;
}

double CameraPictures::light_beside_layers() const {
  if (layer_names_.empty()) return 0;
  double light = 0, difference = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::vector<float> whole = filtered_.mean(c);
    std::vector<double> rest(whole.begin(), whole.end());
    for (std::size_t k = 1; k <= layer_names_.size(); ++k) {
      const std::vector<float> layer = filtered_.mean(3 * k + c);
      for (std::size_t pixel = 0; pixel < rest.size(); ++pixel) rest[pixel] -= double{layer[pixel]};
    }
    for (const float value : whole) light += std::abs(double{value});
    for (const double value : rest) difference += std::abs(value);
  }
  return light > 0 ? difference / light : 0;
}

film::Image CameraPictures::image() const {
  film::Image image;
  image.width = details_.width();
  image.height = details_.height();
  std::string names;
  std::vector<std::string> prefixes = {""};  // by part
  for (const std::string& name : layer_names_) {
    names += (names.empty() ? "" : ",") + name;
    prefixes.push_back(name + ".");
  }
  if (!names.empty()) image.attributes.emplace_back(film::kLightLayers, names);
  if (layers_.alpha) {
    prefixes.push_back(film::kBackground + std::string("."));
    image.attributes.emplace_back(film::kBackgroundIs, film::kApart);
  }
  std::vector<Plane> planes;
  const auto add = [&](const std::string& prefix, const std::string& suffixes,
                       const film::Film& film, std::size_t first = 0) {
    for (std::size_t k = 0; k < suffixes.size(); ++k) {
      planes.push_back({prefix + suffixes[k], &film, first + k, {}});
    }
  };
  const auto add_light = [&](const std::string& prefix, const film::Film& film, std::size_t first) {
    for (std::size_t c = 0; c < 3; ++c) {
      planes.push_back({prefix + "RGB"[c], &film, first + c, c});
    }
  };
  const std::string unfiltered = std::string(film::kUnfiltered) + ".";
  // Where a pixel has no path of its own, filled() takes those around.
  const bool has_holes = layers_.unfiltered && !unfiltered_.has_path_everywhere();
  for (std::size_t part = 0; part < prefixes.size(); ++part) {
    add_light(prefixes[part], filtered_, 3 * part);
    if (layers_.unfiltered && !has_holes) {
      add(unfiltered + prefixes[part], "RGB", unfiltered_, 3 * part);
    }
  }
  if (layers_.neighbors) add("neighbors.", "Y", details_, 0);
  if (layers_.radius) add("radius.", "Y", details_, 1);
  if (layers_.albedo) add("albedo.", "RGB", albedo_);
  if (layers_.normal) add("normal.", "XYZ", normal_);
  if (layers_.alpha) planes.push_back({"A", &alpha_, 0, filter::PixelPlane::kNoLight});
  if (layers_.fireflies) add_light("fireflies.", fireflies_, 0);
  image.layers.resize(planes.size());
  core::parallel_for(planes.size(), 1, [&](std::size_t k, std::size_t) {
    image.layers[k] = {planes[k].name, planes[k].film->mean(planes[k].component)};
  });
  if (!features_.empty()) regress(statistics(), planes, image);
  if (has_holes) {
    for (std::size_t part = 0; part < prefixes.size(); ++part) {
      image.add(unfiltered + prefixes[part], "RGB", filled(part));
    }
  }
  return image;
}

std::uint64_t add_records(const Records& records, const Estimates& estimates,
                          std::span<const float> radius, std::size_t first, std::size_t last,
                          std::span<CameraPictures> pictures) {
  struct Band {
    std::vector<std::size_t> kept;
    std::uint64_t overflows = 0;
  };
  std::vector<Band> bands(pixel_bands());
  const auto picture_of = [&](std::size_t i) -> CameraPictures& {
    return pictures[records.camera.empty() ? 0 : records.camera[i]];
  };
  for_each_by_pixel(records, first, last, [&](std::size_t b, std::span<const std::size_t> some) {
    Band& band = bands[b];
    band.overflows += keep(records, estimates, some, band.kept);
    for (const std::size_t i : band.kept) picture_of(i).add(records, estimates, radius, i);
    // Layer after layer: they lie in as many columns, which are fastest read one at a time.
    for (std::size_t k = 0; k < records.layers.size(); ++k) {
      CameraPictures::add_layer(k, records, estimates, band.kept, pictures);
    }
  });
  std::uint64_t overflows = 0;
  for (const Band& band : bands) overflows += band.overflows;
  return overflows;
}

}  // namespace psf::run
