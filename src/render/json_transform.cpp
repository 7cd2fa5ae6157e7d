// Transforms and repetition of the JSON scene file.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "formats/error.h"
#include "render/json_parts.h"

namespace psf::render {
namespace {

Vec3 read_axis(const JsonCursor& json) {
  static constexpr std::string_view kAxes[] = {"x", "y", "z"};
  if (!json.is_text()) return json.direction();
  Vec3 axis(0, 0, 0);
  axis[static_cast<int>(json.choice(kAxes))] = 1;
  return axis;
}

// One step: an object with one of "translate", "rotate", "scale", "matrix".
Mat4 read_step(const JsonCursor& json) {
  json.check_keys({"translate", "rotate", "axis", "scale", "matrix"});
  const auto translate = json.find("translate"), rotate = json.find("rotate"),
             scale = json.find("scale"), matrix = json.find("matrix");
  if (translate.has_value() + rotate.has_value() + scale.has_value() + matrix.has_value() != 1) {
    json.fail(
        "a step has one of \"translate\", \"rotate\", \"scale\", \"matrix\"; a list of steps may "
        "have more");
  }
  if (json.find("axis") && !rotate) json.fail("\"axis\" belongs to \"rotate\"");
  Mat4 m;
  if (translate) {
    m.setTranslation(translate->vec3());
  } else if (rotate) {
    m.setAxisAngle(read_axis(json.at("axis")), rotate->number() * std::numbers::pi_v<float> / 180);
  } else if (scale) {
    const Vec3 factors = scale->is_array() ? scale->vec3() : Vec3(scale->number());
    if (factors.x == 0 || factors.y == 0 || factors.z == 0) scale->expected("a scale without a 0");
    m.setScale(factors);
  } else {
    const auto v = matrix->numbers(16);
    if (v[12] != 0 || v[13] != 0 || v[14] != 0 || v[15] != 1) {
      matrix->fail("the last row of a matrix is 0, 0, 0, 1 (row by row, column vectors)");
    }
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column)
        m[column][row] = v[static_cast<std::size_t>(4 * row + column)];
    }
  }
  return m;
}

// Copies by one entry of "repeat": step^k behind each placement so far, k = 0 to count - 1.
std::vector<Mat4> repeat(const JsonCursor& json, const std::vector<Mat4>& placements) {
  json.check_keys({"count", "step"});
  const JsonCursor count_json = json.at("count");
  const std::size_t count = count_json.integer(1, kMaxCopies);
  if (count > kMaxCopies / placements.size()) {
    throw Error(ErrorCode::limit,
                fmt::format("{}: {} copies of {} are more than psf takes ({})", count_json.where(),
                            count, placements.size(), kMaxCopies));
  }
  const Mat4 step = read_transform(json.at("step"));
  std::vector<Mat4> result;
  result.reserve(count * placements.size());
  Mat4 power;
  for (std::size_t k = 0; k < count; ++k) {
    for (const Mat4& placement : placements) result.push_back(placement * power);
    power *= step;
  }
  return result;
}

}  // namespace

Mat4 read_transform(const JsonCursor& json) {
  if (!json.is_array()) return read_step(json);
  Mat4 m;
  for (const JsonCursor& step : json.items()) m *= read_step(step);
  return m;
}

std::vector<Mat4> read_placements(const JsonCursor& json) {
  std::vector<Mat4> placements{Mat4()};
  if (const auto transform = json.find("transform")) placements[0] = read_transform(*transform);
  const auto found = json.find("repeat");
  if (!found) return placements;
  if (!found->is_array()) return repeat(*found, placements);
  for (const JsonCursor& entry : found->items()) placements = repeat(entry, placements);
  return placements;
}

}  // namespace psf::render
