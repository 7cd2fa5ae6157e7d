// Finds the points in a ball, by Embree's point queries.
#pragma once

#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "render/accel/accel.h"

namespace psf::render {

class PointIndex {
 public:
  // Throws Error{limit} for more than kMost points, or where Embree reports an error.
  static constexpr std::size_t kMost = std::size_t{1} << 30;
  explicit PointIndex(std::vector<Vec3> points);

  // Appends the numbers of the points at a distance of at most `radius` from `center`, smallest
  // first. Thread-safe.
  void within(const Vec3& center, float radius, std::vector<std::uint32_t>& found) const;

 private:
  std::vector<Vec3> points_;
  EmbreeDevice device_;
  EmbreeScene scene_;
};

}  // namespace psf::render
