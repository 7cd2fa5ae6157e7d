// Rings between the balls that several radii give one query: from a squared distance to its ring.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace psf::filter::engine {

// Query i has the radii scale_k f_i. Ring k holds what is in ball k and not in ball k - 1. The
// squared distance over f_i^2 is a float whose upper bits are the place in a table: 512 places an
// octave. An entry is twice the ring at the place's beginning, and 1 more where a radius lies in
// the place, or so near to it that rounding may matter: then the pair is in this ring or in the
// next, as comparing with that radius itself says, so that its ring is what separate runs say.
// Where there are several such radii the entry is kOpen.
class RingTable {
 public:
  static constexpr std::int32_t kOpen = -1;
  static constexpr int kShift = 14;  // bits of a float that make no place

  // Positive ones between these, so that no square of a radius or distance over- or underflows.
  static constexpr double kLeastScale = 1e-9, kLargestScale = 1e9;
  static constexpr double kLeastBasisSq = 1e-18, kLargestBasisSq = 1e18;
  [[nodiscard]] static bool takes(double scale) {
    return scale == 0 || (scale >= kLeastScale && scale <= kLargestScale);
  }

  // `scales`: ascending, distinct, the last one positive, all taken.
  explicit RingTable(std::span<const double> scales);

  [[nodiscard]] std::span<const double> scales() const { return scales_; }
  [[nodiscard]] std::size_t rings() const { return scales_.size(); }
  // Place p of the table is that of floats whose bits, shifted, are first_place() + p; the first
  // stands for all below too, the last for all above.
  [[nodiscard]] std::int32_t first_place() const { return first_; }
  [[nodiscard]] std::int32_t last_index() const {
    return static_cast<std::int32_t>(table_.size()) - 1;
  }
  [[nodiscard]] const std::int32_t* data() const { return table_.data(); }

 private:
  std::vector<double> scales_;
  std::int32_t first_ = 0;
  std::vector<std::int32_t> table_;
};

}  // namespace psf::filter::engine
