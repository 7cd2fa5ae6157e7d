// How far two pictures are apart.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/vec.h"

namespace psf::tests {

// The largest difference of a value, relative to `b`; infinite where the sizes differ.
inline double largest_difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  constexpr double kDark = 1e-6;
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double scale = std::max(kDark, std::abs(double{b[i][c]}));
      largest = std::max(largest, std::abs(double{a[i][c]} - double{b[i][c]}) / scale);
    }
  }
  return largest;
}

}  // namespace psf::tests
