#include "metrics/flip.h"

#include <algorithm>
#include <cmath>

#include "metrics/flip_color.h"

namespace psf::metrics {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr float kColorExponent = 0.7f;
constexpr float kKnee = 0.4f, kKneeValue = 0.95f;  // p_c, p_t: where large colour errors are bent
constexpr double kFeatureWidth = 0.082;            // degrees

const FlipColor& colors() {
  static const FlipColor colors;
  return colors;
}

Displayed planes_like(const Plane& plane) {
  const Plane empty(plane.width(), plane.height());
  return {empty, empty, empty};
}

Vec3 at(const Displayed& planes, std::size_t y, std::size_t x) {
  return {planes[0].row(y)[x], planes[1].row(y)[x], planes[2].row(y)[x]};
}

void set(Displayed& planes, std::size_t y, std::size_t x, const Vec3& value) {
  for (unsigned k = 0; k < 3; ++k) planes[k].row(y)[x] = value[static_cast<int>(k)];
}

// weight(x) for x = -radius ... radius.
template <class Weight>
std::vector<double> sampled(int radius, const Weight& weight) {
  std::vector<double> values;
  for (int x = -radius; x <= radius; ++x) values.push_back(weight(static_cast<double>(x)));
  return values;
}

double sum(const std::vector<double>& values) {
  double total = 0;
  for (const double value : values) total += value;
  return total;
}

Kernel scaled(const std::vector<double>& values, double factor) {
  Kernel kernel;
  for (const double value : values) kernel.push_back(static_cast<float>(value * factor));
  return kernel;
}

// The positive weights add up to 1, the negative ones to -1.
Kernel balanced(const std::vector<double>& values) {
  double positive = 0, negative = 0;
  for (const double value : values) (value > 0 ? positive : negative) += std::abs(value);
  Kernel kernel;
  for (const double value : values) {
    kernel.push_back(static_cast<float>(value / (value > 0 ? positive : negative)));
  }
  return kernel;
}

// How strong a feature is, in whichever direction.
Plane magnitude(const Plane& horizontal, const Plane& vertical) {
  Plane result(horizontal.width(), horizontal.height());
  for_pixels(result, [&](std::size_t y, std::size_t x) {
    const float h = horizontal.row(y)[x], v = vertical.row(y)[x];
    result.row(y)[x] = std::sqrt(h * h + v * v);
  });
  return result;
}

// The largest colour error there is, raised to the exponent: green against blue.
float largest_color_error() {
  static const float error =
      std::pow(hyab(colors().hunt_lab({0, 1, 0}), colors().hunt_lab({0, 0, 1})), kColorExponent);
  return error;
}

float color_error(const Vec3& a, const Vec3& b) {
  const float error = std::pow(hyab(a, b), kColorExponent);
  const float largest = largest_color_error(), knee = kKnee * largest;
  if (error < knee) return error * (kKneeValue / knee);
  return kKneeValue + (error - knee) / (largest - knee) * (1 - kKneeValue);
}

}  // namespace

Flip::Kernels Flip::kernels(double pixels_per_degree) {
  // Gaussians a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees.
  constexpr double kAchromatic = 0.0047, kRedGreen = 0.0053;
  constexpr double kBlueYellow[2] = {0.04, 0.025}, kBlueYellowWeight[2] = {34.1, 13.5};
  const auto radius = static_cast<int>(
      std::ceil(3 * std::sqrt(kBlueYellow[0] / (2 * kPi * kPi)) * pixels_per_degree));
  const auto gaussian = [&](double b) {
    return sampled(radius, [&](double x) {
      return std::exp(-kPi * kPi * x * x / (b * pixels_per_degree * pixels_per_degree));
    });
  };
  Kernels kernels;
  const std::vector<double> achromatic = gaussian(kAchromatic), red_green = gaussian(kRedGreen);
  kernels.achromatic = scaled(achromatic, 1 / sum(achromatic));
  kernels.red_green = scaled(red_green, 1 / sum(red_green));
  // The sum of two Gaussians is normalised as a whole, in two dimensions; each kernel is applied
  // along both axes, so it carries the root of its weight.
  const std::vector<double> first = gaussian(kBlueYellow[0]), second = gaussian(kBlueYellow[1]);
  const double weight_1 = kBlueYellowWeight[0] * std::sqrt(kPi / kBlueYellow[0]);
  const double weight_2 = kBlueYellowWeight[1] * std::sqrt(kPi / kBlueYellow[1]);
  const double total = weight_1 * sum(first) * sum(first) + weight_2 * sum(second) * sum(second);
  kernels.blue_yellow_1 = scaled(first, std::sqrt(weight_1 / total));
  kernels.blue_yellow_2 = scaled(second, std::sqrt(weight_2 / total));

  const double sigma = 0.5 * kFeatureWidth * pixels_per_degree;
  const auto reach = static_cast<int>(std::ceil(3 * sigma));
  const auto bell = [&](double x) { return std::exp(-x * x / (2 * sigma * sigma)); };
  const std::vector<double> smooth = sampled(reach, bell);
  kernels.smooth = scaled(smooth, 1 / sum(smooth));
  kernels.edge = balanced(sampled(reach, [&](double x) { return -x * bell(x); }));
  kernels.point =
      balanced(sampled(reach, [&](double x) { return (x * x / (sigma * sigma) - 1) * bell(x); }));
  return kernels;
}

Flip::Features Flip::features(const Displayed& picture) const {
  Displayed opponent = planes_like(picture[0]);
  Plane lightness(picture[0].width(), picture[0].height());
  for_pixels(lightness, [&](std::size_t y, std::size_t x) {
    const Vec3 color = colors().opponent(at(picture, y, x));
    set(opponent, y, x, color);
    lightness.row(y)[x] = (color.x + 16) / 116;
  });

  const auto blurred = [](const Plane& plane, const Kernel& kernel) {
    return along_columns(along_rows(plane, kernel), kernel);
  };
  Displayed seen = {blurred(opponent[0], kernels_.achromatic),
                    blurred(opponent[1], kernels_.red_green),
                    blurred(opponent[2], kernels_.blue_yellow_1)};
  const Plane second = blurred(opponent[2], kernels_.blue_yellow_2);
  Features result;
  result.color = planes_like(lightness);
  for_pixels(lightness, [&](std::size_t y, std::size_t x) {
    const Vec3 color = at(seen, y, x) + Vec3(0, 0, second.row(y)[x]);
    set(result.color, y, x, colors().hunt_lab(colors().linear(color)));
  });

  const Plane smooth = along_rows(lightness, kernels_.smooth);
  result.edge = magnitude(along_columns(along_rows(lightness, kernels_.edge), kernels_.smooth),
                          along_columns(smooth, kernels_.edge));
  result.point = magnitude(along_columns(along_rows(lightness, kernels_.point), kernels_.smooth),
                           along_columns(smooth, kernels_.point));
  return result;
}

Flip::Flip(const Displayed& reference, double pixels_per_degree)
    : kernels_(kernels(pixels_per_degree)), reference_(features(reference)) {}

void Flip::measure(const Displayed& picture, std::span<double> errors) const {
  const Features seen = features(picture);
  const std::size_t width = seen.edge.width();
  for_pixels(seen.edge, [&](std::size_t y, std::size_t x) {
    const float color = color_error(at(seen.color, y, x), at(reference_.color, y, x));
    const float edge = std::abs(seen.edge.row(y)[x] - reference_.edge.row(y)[x]);
    const float point = std::abs(seen.point.row(y)[x] - reference_.point.row(y)[x]);
    const float feature = std::sqrt(std::max(edge, point) / std::sqrt(2.0f));
    errors[y * width + x] = static_cast<double>(std::pow(color, 1 - feature));
  });
}

}  // namespace psf::metrics
