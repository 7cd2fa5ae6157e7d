// Finds those of many boxes that are near a given box: FLANN over the centres proposes boxes, their
// bounds decide.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/vec.h"

namespace psf::search {

// A closed box; low <= high in every component, all finite.
struct Box {
  Vec3 low, high;
};

// The squared distance between two boxes, squared world units, with the operations of
// distance_sq(). Because rounding is monotone, it is at most the distance_sq() of any two points in
// the boxes.
[[nodiscard]] float gap_sq(const Box& a, const Box& b);

// Boxes are kept in classes of similar size, each with a FLANN index, so that a few large boxes do
// not make every search slower.
class BoxIndex {
 public:
  explicit BoxIndex(std::vector<Box> boxes);
  ~BoxIndex();

  // The numbers of all boxes with gap_sq < r_sq, ascending. `out` is cleared first. Any number of
  // threads may ask at once.
  void within(const Box& box, float r_sq, std::vector<std::uint32_t>& out) const;

 private:
  struct SizeClass;

  std::vector<Box> boxes_;
  std::vector<SizeClass> classes_;
  float largest_coordinate_ = 0;  // largest absolute value of any coordinate
};

}  // namespace psf::search
