#include "search/brute_force.h"

#include <algorithm>

namespace psf::search {

BruteForce::BruteForce(std::span<const Vec3> points) : points_(points.begin(), points.end()) {}

void BruteForce::within(const Vec3& center, float r_sq, std::vector<Neighbor>& out) const {
  out.clear();
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const float d_sq = distance_sq(center, points_[k]);
    if (chi_ball(d_sq, r_sq)) out.push_back({static_cast<std::uint32_t>(k), d_sq});
  }
}

void BruteForce::nearest(const Vec3& center, std::size_t k, std::vector<Neighbor>& out) const {
  out.clear();
  for (std::size_t p = 0; p < points_.size(); ++p) {
    out.push_back({static_cast<std::uint32_t>(p), distance_sq(center, points_[p])});
  }
  const auto closer = [](const Neighbor& a, const Neighbor& b) {
    return a.d_sq != b.d_sq ? a.d_sq < b.d_sq : a.index < b.index;
  };
  const auto end = out.begin() + static_cast<std::ptrdiff_t>(std::min(k, out.size()));
  std::partial_sort(out.begin(), end, out.end(), closer);
  out.erase(end, out.end());
}

}  // namespace psf::search
