// Transforms and repetition of the JSON scene file.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "render/scene/json/parts.h"

namespace psf::render {
namespace {

// In float or double: products of floats are those of every ordinary scene, to the last bit.
template <class T>
Imath::Vec3<T> read_axis(const JsonCursor& json) {
  static constexpr std::string_view kAxes[] = {"x", "y", "z"};
  if (!json.is_text()) return Imath::Vec3<T>(json.direction());
  Imath::Vec3<T> axis(0, 0, 0);
  axis[static_cast<int>(json.choice(kAxes))] = 1;
  return axis;
}

// One step: an object with one of "translate", "rotate", "scale", "matrix".
template <class T>
Imath::Matrix44<T> read_step(const JsonCursor& json) {
  json.check_keys({"translate", "rotate", "axis", "scale", "matrix"});
  const auto translate = json.find("translate"), rotate = json.find("rotate"),
             scale = json.find("scale"), matrix = json.find("matrix");
  if (translate.has_value() + rotate.has_value() + scale.has_value() + matrix.has_value() != 1) {
    json.fail(
        "a step has one of \"translate\", \"rotate\", \"scale\", \"matrix\"; a list of steps may "
        "have more");
  }
  if (json.find("axis") && !rotate) json.fail("\"axis\" belongs to \"rotate\"");
  Imath::Matrix44<T> m;
  if (translate) {
    m.setTranslation(Imath::Vec3<T>(translate->vec3d()));
  } else if (rotate) {
    m.setAxisAngle(read_axis<T>(json.at("axis")),
                   static_cast<T>(rotate->real()) * std::numbers::pi_v<T> / 180);
  } else if (scale) {
    const auto factors =
        Imath::Vec3<T>(scale->is_array() ? scale->vec3d() : Imath::V3d(scale->real()));
    if (factors.x == 0 || factors.y == 0 || factors.z == 0) scale->expected("a scale without a 0");
    m.setScale(factors);
  } else {
    const auto v = matrix->numbers(16);
    if (v[12] != 0 || v[13] != 0 || v[14] != 0 || v[15] != 1) {
      matrix->fail("the last row of a matrix is 0, 0, 0, 1 (row by row, column vectors)");
    }
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column)
        m[column][row] = static_cast<T>(v[static_cast<std::size_t>(4 * row + column)]);
    }
  }
  return m;
}

template <class T>
Imath::Matrix44<T> read_steps(const JsonCursor& json) {
  if (!json.is_array()) return read_step<T>(json);
  Imath::Matrix44<T> m;
  for (const JsonCursor& step : json.items()) m *= read_step<T>(step);
  return m;
}

Placement read_transform(const JsonCursor& json, bool exact) {
  return exact ? read_steps<double>(json) : Placement(read_steps<float>(json));
}

// Copies by one entry of "repeat": step^k behind each placement so far, k = 0 to count - 1.
std::vector<Placement> repeat(const JsonCursor& json, const std::vector<Placement>& placements,
                              bool exact) {
  json.check_keys({"count", "step"});
  const JsonCursor count_json = json.at("count");
  const std::size_t count = count_json.integer(1, kMaxCopies);
  if (count > kMaxCopies / placements.size()) {
    throw Error(ErrorCode::limit,
                fmt::format("{}: {} copies of {} are more than psf takes ({})", count_json.where(),
                            count, placements.size(), kMaxCopies));
  }
  const Placement step = read_transform(json.at("step"), exact);
  std::vector<Placement> result;
  result.reserve(count * placements.size());
  Placement power;
  for (std::size_t k = 0; k < count; ++k) {
    for (const Placement& placement : placements) {
      result.push_back(product(placement, power, exact));
    }
    power = product(power, step, exact);
  }
  return result;
}

}  // namespace

std::vector<Placement> combine(const JsonCursor& json, const std::vector<Placement>& inner,
                               const std::vector<Placement>& outer, bool exact) {
  if (inner.size() > kMaxCopies / outer.size()) {
    throw Error(ErrorCode::limit, fmt::format("{}: more than {} copies", json.where(), kMaxCopies));
  }
  std::vector<Placement> all;
  all.reserve(inner.size() * outer.size());
  for (const Placement& o : outer) {
    for (const Placement& i : inner) all.push_back(product(i, o, exact));
  }
  return all;
}

Placement product(const Placement& a, const Placement& b, bool exact) {
  return exact ? a * b : Placement(Mat4(a) * Mat4(b));
}

std::vector<Placement> read_placements(const JsonCursor& json, Scene& scene) {
  const bool exact = scene.space.exact;
  std::vector<Placement> placements{Placement()};
  if (const auto transform = json.find("transform")) {
    placements[0] = read_transform(*transform, exact);
  }
  if (const auto keys = json.find("keyframes")) {
    placements[0] = product(placements[0], read_keyed_placement(*keys, scene), exact);
  }
  const auto found = json.find("repeat"), scattered = json.find("scatter");
  if (found && !found->is_array()) placements = repeat(*found, placements, exact);
  if (found && found->is_array()) {
    for (const JsonCursor& entry : found->items()) placements = repeat(entry, placements, exact);
  }
  if (scattered) {
    placements = combine(*scattered, placements, read_scatter(*scattered), exact);
  }
  return placements;
}

}  // namespace psf::render
