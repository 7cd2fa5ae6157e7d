// A block's lengths in a unit in which their squares are floats.
#pragma once

#include <span>
#include <vector>

#include "filter/records.h"

namespace psf::filter {

// Searches and terms compare squared lengths, in float: beyond about 1e19 those are infinite, below
// about 1e-19 they lose digits and become 0. Lengths of such a block are multiplied by a power of
// two, which is exact, so that all comparisons are as they would be at the scale of 1. A block
// whose lengths need no other unit is taken as it is, and nothing is copied.
//
// Radii count first: least and greatest are kept within 2^-58 and 2^58. A block whose radii span
// more than that, or whose least radius and largest coordinate are more than about 2^183 apart, is
// taken as it is; there, a radius below 2^-75 finds its own record alone.
class Scaled {
 public:
  // `radius`: r_i of every record, world units. `least_share`: what is compared are the radii and
  // parts of them down to this, in (0, 1]. Both are borrowed.
  Scaled(const Records& records, std::span<const float> radius, double least_share = 1);

  // `position`, `distance` and r_i in the unit; every other column as it was, h_i too, of which
  // only quotients count.
  [[nodiscard]] const Records& records() const { return records_; }
  [[nodiscard]] std::span<const float> radius() const { return radius_; }

  // Whether radii span so little that there is a unit for all of them.
  [[nodiscard]] bool fits() const { return fits_; }
  // The unit: what is here times 2^exponent() is a world unit.
  [[nodiscard]] int exponent() const { return exponent_; }
  [[nodiscard]] float to_world(float length) const;
  [[nodiscard]] float from_world(float length) const;

 private:
  Records records_;
  std::span<const float> radius_;
  int exponent_ = 0;
  bool fits_ = true;
  std::vector<Vec3> positions_;
  std::vector<float> distances_, radii_;
};

}  // namespace psf::filter
