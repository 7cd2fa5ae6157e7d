// Built-in scenes whose filtered pictures are known in closed form, to check convergence studies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/vec.h"
#include "filter/parameters/parameters.h"
#include "study/replicates.h"

namespace psf::study {

// The unit square, seen from above at distance 1 by kSize x kSize pixels. Each pass has one path
// per pixel, at a random place in the pixel. c is f(x) times an exponential random number of mean
// 1.
enum class AnalyticScene : std::uint8_t {
  smooth,  // f = 1 + cos(4 pi x) / 2
  edge     // f = 1 left of the middle, 3 right of it
};

class Analytic {
 public:
  static constexpr std::size_t kSize = 128;  // pixels

  explicit Analytic(AnalyticScene scene) : scene_(scene) {}

  [[nodiscard]] const char* name() const;  // "smooth", "edge"
  // The means of f over the pixels, (kSize, kSize).
  [[nodiscard]] std::vector<Rgb> reference() const;
  // Writes a dump. Dumps of different seeds are independent.
  void write_dump(const std::string& path, std::uint64_t seed, std::uint64_t passes) const;

  // The pixels whose balls of this radius, in pixels, are not cut by the border of the square.
  [[nodiscard]] static Rectangle inside(double radius);

  // The expected `bias_sq` after n passes, for blocks of one pass, no weights and a radius in
  // pixels: the mean over `inside` of the squared difference of expected picture and reference,
  // over reference^2 + epsilon. The share that a record itself has in its ball is neglected.
  [[nodiscard]] double bias_sq(const filter::Radius& radius, std::uint64_t n, double epsilon,
                               const Rectangle& inside) const;

 private:
  [[nodiscard]] double f(double x) const;
  // Mean of f over a disk of radius r around a point.
  [[nodiscard]] double f_over_disk(double x, double r) const;

  AnalyticScene scene_;
};

// The slope of a straight line through log(value) over log(n), by least squares.
[[nodiscard]] double fitted_slope(const std::vector<double>& n, const std::vector<double>& values);

}  // namespace psf::study
