// Which of many boxes may be near a box: FLANN over their centres proposes, their bounds decide.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/vec.h"

namespace psf::search {

// Closed, low <= high in every component, finite.
struct Box {
  Vec3 low, high;
};

// The distance between two boxes in the operations of distance_sq(): by rounding's monotony it is
// at most that of any two points in them, to the last bit. Squared world units.
[[nodiscard]] float gap_sq(const Box& a, const Box& b);

// Boxes are kept in classes of similar size, a FLANN index each, so that a few large ones do not
// lengthen the search for all.
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
  float largest_coordinate_ = 0;  // in absolute value
};

}  // namespace psf::search
