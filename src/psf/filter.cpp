#include "psf/filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "filter/blocks.h"
#include "filter/channels.h"
#include "filter/estimate.h"
#include "filter/places.h"
#include "filter/radius.h"
#include "psf/library.h"
#include "run/pictures.h"

namespace psf {
namespace {

// The records of the library as those of the filter. Vec3 and Rgb are three packed floats.
class Columns {
 public:
  explicit Columns(const Records& records) : count_(records.pixel.size()), r_(records) {
    if (records.flags.empty()) flags_.assign(count_, filter::kHasVertex | filter::kShaded);
  }

  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] filter::Records view() const {
    filter::Records view;
    view.flags = r_.flags.empty() ? std::span<const std::uint8_t>(flags_) : one("flags", r_.flags);
    view.position = three<Vec3>("position", r_.position, true);
    view.throughput = three<Rgb>("throughput", r_.throughput, true);
    view.contribution = three<Rgb>("contribution", r_.contribution, true);
    view.pixel = r_.pixel;
    view.distance = one("distance", r_.distance);
    view.unfiltered = three<Rgb>("unfiltered", r_.unfiltered);
    view.normal = three<Vec3>("normal", r_.normal);
    view.reflectance = three<Rgb>("reflectance", r_.reflectance);
    view.direction = three<Vec3>("direction", r_.direction);
    view.hit_distance = one("hit_distance", r_.hit_distance);
    view.roughness = one("roughness", r_.roughness);
    view.visibility = one("visibility", r_.visibility);
    view.material = one("material", r_.material);
    view.camera = one("camera", r_.camera);
    view.kind = one("kind", r_.kind);
    return view;
  }

 private:
  void check(const char* name, std::size_t values, std::size_t components, bool needed) const {
    if (values == count_ * components || (values == 0 && !needed)) return;
    throw Error(ErrorCode::usage,
                fmt::format("`{}`: {} values, expected {} x {}, for {} of `pixel`", name, values,
                            count_, components, count_));
  }
  template <class T>
  std::span<const T> one(const char* name, std::span<const T> values) const {
    check(name, values.size(), 1, false);
    return values;
  }
  template <class T>
  std::span<const T> three(const char* name, std::span<const float> values,
                           bool needed = false) const {
    static_assert(sizeof(T) == 3 * sizeof(float));
    check(name, values.size(), 3, needed);
    return {reinterpret_cast<const T*>(values.data()), values.size() / 3};
  }

  std::size_t count_;
  Records r_;
  std::vector<std::uint8_t> flags_;
};

// As of a dump: sizes that a picture can have.
void check_cameras(std::span<const Camera> cameras, std::size_t records) {
  if (cameras.empty()) throw Error(ErrorCode::usage, "`cameras`: at least one is needed");
  std::uint64_t pixels = 0;
  for (const Camera& camera : cameras) {
    const std::uint64_t own = std::uint64_t{camera.width} * camera.height;
    if (own == 0 || own > filter::kMostPixels - pixels) {
      throw Error(ErrorCode::bad_input, fmt::format("camera {}: {} x {} is no size for a picture",
                                                    camera.name, camera.width, camera.height));
    }
    pixels += own;
  }
  if (records > filter::kMostPaths) {
    throw Error(ErrorCode::limit, fmt::format("{} records are more than a block may have, {}",
                                              records, filter::kMostPaths));
  }
}

void check_places(const filter::Records& records, std::span<const filter::CameraView> cameras) {
  const std::optional<std::size_t> i =
      filter::first_misplaced(records.pixel, records.camera, cameras);
  if (!i) return;
  const std::size_t camera = records.camera.empty() ? 0 : records.camera[*i];
  if (camera >= cameras.size()) {
    throw Error(ErrorCode::bad_input, fmt::format("record {}: there is no camera {}", *i, camera));
  }
  throw Error(
      ErrorCode::bad_input,
      fmt::format("record {}: pixel {} of camera {}, which has {} x {}", *i, records.pixel[*i],
                  camera, cameras[camera].width, cameras[camera].height));
}

// What radii need beside the channels of the weights.
void check_radius(const filter::Parameters& parameters, const filter::Records& records,
                  std::span<const Camera> cameras) {
  if (filter::needs_distance(parameters) && records.distance.empty() && records.size() > 0) {
    throw Error(ErrorCode::bad_input,
                "the records have no channel distance, which a radius that depends on the distance "
                "needs; give it, or `r0` in world units, such as `r0 0.5wu`");
  }
  if (!filter::needs_angle(parameters)) return;
  for (const Camera& camera : cameras) {
    if (std::isfinite(camera.angle_per_pixel) && camera.angle_per_pixel > 0) continue;
    const bool by_radius = parameters.radius.basis == filter::RadiusBasis::footprint;
    throw Error(ErrorCode::bad_input,
                by_radius ? "a camera has no angle_per_pixel, which a radius in pixels needs; give "
                            "it, or the radius as a fraction of the distance, `r0 0.02`"
                          : fmt::format("a camera has no angle_per_pixel, which `estimator {}` "
                                        "needs; give it, or `estimator average`",
                                        filter::info(parameters.estimator).name));
  }
}

}  // namespace

FilteredRecords filter_records(const Records& records, std::span<const Camera> cameras,
                               const Parameters& parameters, double n) {
  check_cameras(cameras, records.pixel.size());
  const Columns columns(records);
  const filter::Records view = columns.view();
  const filter::Parameters chosen = [&] {
    filter::Parameters p = to_filter(parameters);
    const filter::TermSet asked = filter::asked_terms(parameters.given());
    for (const filter::ChannelNeed& need : filter::optional_channels(p)) {
      if (need.term && (asked & filter::bit(*need.term)) == 0 &&
          !filter::has_channel(view, need.channel)) {
        p.weights.switch_off(*need.term);
      }
    }
    return p;
  }();
  check_radius(chosen, view, cameras);

  std::vector<filter::CameraView> views;
  double pixels = 0;
  for (const Camera& camera : cameras) {
    views.push_back({camera.width, camera.height, camera.angle_per_pixel});
    pixels += static_cast<double>(camera.width) * camera.height;
  }
  check_places(view, views);
  const double samples = std::max(1.0, static_cast<double>(columns.size()) / pixels);
  // One block, the first.
  const double counted = chosen.radius.count == filter::RadiusCount::blocks ? 1 : samples;
  const filter::Block block{0, n > 0 ? n : counted, samples, views};

  FilteredRecords result;
  filter::radii(chosen.radius, view, block, result.radius);
  filter::Estimates estimates = filter::estimate(view, result.radius, block, chosen);
  std::vector<run::CameraPictures> pictures;
  for (const filter::CameraView& camera : views) {
    run::PictureLayers layers;
    layers.albedo = !view.reflectance.empty();
    layers.normal = !view.normal.empty();
    layers.alpha = false;  // records in memory have none
    layers.fireflies = chosen.fireflies.spreads();
    pictures.emplace_back(camera, layers, chosen.pixels);
  }
  static_cast<void>(run::add_records(view, estimates, result.radius, 0, columns.size(), pictures));
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    result.pictures.push_back(to_picture(pictures[k].image(), cameras[k].name));
  }
  result.c_bar.resize(3 * columns.size());
  for (std::size_t i = 0; i < estimates.c_bar.size(); ++i) {
    const Rgb& color = estimates.c_bar[i];
    result.c_bar[3 * i] = color.x;
    result.c_bar[3 * i + 1] = color.y;
    result.c_bar[3 * i + 2] = color.z;
  }
  result.neighbors = std::move(estimates.neighbors);
  if (!estimates.radius.empty()) result.radius = std::move(estimates.radius);
  return result;
}

}  // namespace psf
