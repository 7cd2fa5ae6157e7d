// Records that own their columns; random ones to filter, and terms that refuse some of their pairs.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "filter/parameters/parameters.h"
#include "filter/records.h"

namespace psf::tests {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct RecordSet {
  std::vector<std::uint8_t> flags;
  std::vector<Vec3> position;
  std::vector<float> distance;
  std::vector<Rgb> throughput, contribution, unfiltered;
  std::vector<std::uint32_t> pixel;
  std::vector<std::uint16_t> camera;
  std::vector<Vec3> normal;
  std::vector<Rgb> reflectance;
  std::vector<std::uint32_t> visibility;
  std::vector<float> hit_distance;
  std::vector<Vec3> direction;
  std::vector<std::uint32_t> material;
  std::vector<float> roughness;

  explicit RecordSet(std::size_t count)
      : flags(count, filter::kHasVertex | filter::kShaded),
        position(count, Vec3(0, 0, 0)),
        distance(count, 1),
        throughput(count, Rgb(1, 1, 1)),
        contribution(count, Rgb(1, 1, 1)),
        unfiltered(count, Rgb(0, 0, 0)),
        pixel(count),
        camera(count),
        normal(count, Vec3(0, 1, 0)),
        reflectance(count, Rgb(0.5f, 0.5f, 0.5f)),
        visibility(count),
        hit_distance(count, 1),
        direction(count, Vec3(0, 1, 0)),
        material(count),
        roughness(count, 1) {}

  [[nodiscard]] std::size_t size() const { return flags.size(); }
  // Records [first, last) as the filter sees them.
  [[nodiscard]] filter::Records view(std::size_t first, std::size_t last) const {
    const auto part = [&](const auto& column) {
      return std::span(column).subspan(first, last - first);
    };
    return {part(flags),        part(position),    part(distance),   part(throughput),
            part(contribution), part(unfiltered),  part(pixel),      part(camera),
            part(normal),       part(reflectance), part(visibility), part(hit_distance),
            part(direction),    part(material),    part(roughness)};
  }
  [[nodiscard]] filter::Records view() const { return view(0, size()); }
};

// On a lattice of 1/64 in a unit cube, with duplicates; normals, reflectances and the rest from few
// values, so that decisions of the weights are clear and rounding cannot flip them.
// `share_unshaded` of the vertices have no contribution, a tenth of the paths no vertex. Pixels run
// through the cameras' pictures in order.
inline RecordSet random_records(std::size_t count, std::uint32_t seed, double share_unshaded,
                                const std::vector<filter::CameraView>& cameras) {
  std::mt19937 random(seed);
  const auto below = [&random](std::uint32_t n) {
    return static_cast<std::uint32_t>(random() % n);
  };
  const auto unit = [&random] { return std::uniform_real_distribution<float>(0, 1)(random); };
  std::mt19937 again(seed + 1);
  RecordSet set(count);
  std::uint32_t camera = 0, pixel = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (below(10) == 0)
      set.flags[i] = 0;
    else if (double{unit()} < share_unshaded)
      set.flags[i] = filter::kHasVertex;
    for (int axis = 0; axis < 3; ++axis) set.position[i][axis] = static_cast<float>(below(64)) / 64;
    if (i > 0 && below(8) == 0)
      set.position[i] = set.position[below(static_cast<std::uint32_t>(i))];
    set.distance[i] = 1 + unit();
    set.throughput[i] = Rgb(unit(), unit(), unit());
    set.contribution[i] = Rgb(3 * unit(), unit(), 0.1f * unit());
    set.unfiltered[i] = below(3) == 0 ? Rgb(unit(), unit(), unit()) : Rgb(0, 0, 0);
    const float angle = 0.25f * static_cast<float>(below(7));
    set.normal[i] = Vec3(std::cos(angle), std::sin(angle), 0);
    set.direction[i] = Vec3(0, std::cos(angle), std::sin(angle));
    const std::uint32_t shade = below(4);
    set.reflectance[i] = Rgb(0.03f * static_cast<float>(shade), 0.5f, shade == 3 ? 0.0f : 0.25f);
    set.visibility[i] = below(3);
    set.hit_distance[i] = below(4) == 0 ? std::numeric_limits<float>::infinity()
                                        : 0.7f * static_cast<float>(1 + below(8));
    set.material[i] = below(2);
    set.roughness[i] = std::array{0.55f, 0.8f, 0.95f, 1.0f}[again() % 4];
    set.camera[i] = static_cast<std::uint16_t>(camera);
    set.pixel[i] = pixel;
    if (++pixel == cameras[camera].width * cameras[camera].height) {
      pixel = 0;
      camera = (camera + 1) % static_cast<std::uint32_t>(cameras.size());
    }
  }
  return set;
}

// Bit k: term k, at thresholds that some pairs of random_records() pass and some do not.
inline filter::WeightTerms terms_of(unsigned bits) {
  filter::WeightTerms terms = filter::WeightTerms::none();
  if ((bits & 1) != 0) terms.normal = 0.93f;
  if ((bits & 2) != 0) terms.reflectance = 0.05f;
  terms.visibility = (bits & 4) != 0;
  if ((bits & 8) != 0) terms.hit_distance = 0.3f;
  if ((bits & 16) != 0) terms.plane = 0.4f;
  if ((bits & 32) != 0) terms.direction = 0.93f;
  terms.material = (bits & 64) != 0;
  if ((bits & 128) != 0) terms.gloss = 6.0f;
  return terms;
}

}  // namespace psf::tests
