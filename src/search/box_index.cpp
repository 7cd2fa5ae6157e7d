#include "search/box_index.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "search/index.h"

namespace psf::search {
namespace {

// Below this many boxes a look at each costs less than a search.
constexpr std::size_t kFewest = 32;
// A class holds boxes whose half diagonals are within a power of this of each other.
constexpr float kClassRatio = 2;
// For the roundings of half diagonals and distances, of centres by the size of their coordinates,
// and of squares that are too small for a float.
constexpr float kEnlarge = 1.0001f;
constexpr float kOfCoordinates = 4 * std::numeric_limits<float>::epsilon();
constexpr float kLeast = 1e-18f;

Vec3 center(const Box& box) {
  return (box.low + box.high) * 0.5f;
}
float half_diagonal(const Box& box) {
  return 0.5f * std::sqrt(length_sq(box.high - box.low));
}

float largest_coordinate(const Box& box) {
  float largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    largest = std::max({largest, std::abs(box.low[axis]), std::abs(box.high[axis])});
  }
  return largest;
}

float gap(float a_low, float a_high, float b_low, float b_high) {
  return std::max(std::max(a_low - b_high, b_low - a_high), 0.0f);
}

}  // namespace

float gap_sq(const Box& a, const Box& b) {
  return distance_sq(gap(a.low.x, a.high.x, b.low.x, b.high.x),
                     gap(a.low.y, a.high.y, b.low.y, b.high.y),
                     gap(a.low.z, a.high.z, b.low.z, b.high.z));
}

struct BoxIndex::SizeClass {
  std::vector<std::uint32_t> numbers;  // numbers of its boxes, ascending
  float half_diagonal = 0;             // half of the longest diagonal of its boxes
  std::unique_ptr<Index> centers;      // null for few boxes
};

BoxIndex::BoxIndex(std::vector<Box> boxes) : boxes_(std::move(boxes)) {
  std::map<int, std::vector<std::uint32_t>> by_size;
  for (std::size_t k = 0; k < boxes_.size(); ++k) {
    largest_coordinate_ = std::max(largest_coordinate_, largest_coordinate(boxes_[k]));
    const float half = half_diagonal(boxes_[k]);
    const int size = half > 0 ? static_cast<int>(std::log(half) / std::log(kClassRatio)) : -1000;
    by_size[size].push_back(static_cast<std::uint32_t>(k));
  }
  for (auto& [size, numbers] : by_size) {
    SizeClass one;
    std::vector<Vec3> centers;
    for (const std::uint32_t k : numbers) {
      one.half_diagonal = std::max(one.half_diagonal, half_diagonal(boxes_[k]));
      centers.push_back(center(boxes_[k]));
    }
    if (numbers.size() >= kFewest) one.centers = std::make_unique<Index>(centers);
    one.numbers = std::move(numbers);
    classes_.push_back(std::move(one));
  }
}

BoxIndex::~BoxIndex() = default;

void BoxIndex::within(const Box& box, float r_sq, std::vector<std::uint32_t>& out) const {
  out.clear();
  const auto decide = [&](std::uint32_t k) {
    if (chi_ball(gap_sq(box, boxes_[k]), r_sq)) out.push_back(k);
  };
  std::vector<Neighbor> found;
  const float margin =
      std::max(largest_coordinate_, largest_coordinate(box)) * kOfCoordinates + kLeast;
  for (const SizeClass& one : classes_) {
    const float reach =
        (half_diagonal(box) + one.half_diagonal + std::sqrt(r_sq)) * kEnlarge + margin;
    if (one.centers && std::isfinite(reach * reach)) {
      one.centers->within(center(box), reach * reach, found);
      for (const Neighbor& neighbor : found) decide(one.numbers[neighbor.index]);
    } else {
      for (const std::uint32_t k : one.numbers) decide(k);
    }
  }
  std::sort(out.begin(), out.end());
}

}  // namespace psf::search
