// A block's lengths in a unit in which their squares are floats.
#pragma once

#include <span>
#include <vector>

#include "filter/records.h"

namespace psf::filter {

// Searches and terms compare squared lengths in float. The squares of lengths above about 1e19 are
// infinite; those of lengths below about 1e-19 lose digits or become 0. Lengths of such a block are
// multiplied by a power of two, which is exact, so that all comparisons come out as they would near
// a scale of 1. A block whose lengths need no other unit is used as it is, and nothing is copied.
//
// The unit is chosen so that the least and the greatest radius lie within 2^-58 and 2^58. A block
// whose radii span more than that, or whose least radius and largest coordinate differ by more than
// about 2^183, is used as it is; there, a radius below 2^-75 finds its own record alone.
class Scaled {
 public:
  // `radius`: r_i of every record, world units. `least_share`, in (0, 1]: the least share of a
  // radius that will be used as a radius as well. Records and radii are borrowed.
  Scaled(const Records& records, std::span<const float> radius, double least_share = 1);

  // The records with `position` and `distance` in the new unit, and photons with `position` and
  // `power`, which is of an area. Every other column is unchanged; h_i too, of which only quotients
  // matter.
  [[nodiscard]] const Records& records() const { return records_; }
  [[nodiscard]] std::span<const float> radius() const { return radius_; }

  // Whether there is a unit that suits all lengths of the block.
  [[nodiscard]] bool fits() const { return fits_; }
  // The unit: a length of records() or radius() times 2^-exponent() is in world units.
  [[nodiscard]] int exponent() const { return exponent_; }
  [[nodiscard]] float to_world(float length) const;
  [[nodiscard]] float from_world(float length) const;

 private:
  Records records_;
  std::span<const float> radius_;
  int exponent_ = 0;
  bool fits_ = true;
  std::vector<Vec3> positions_, photon_positions_;
  std::vector<Rgb> powers_;
  std::vector<float> distances_, radii_;
};

}  // namespace psf::filter
