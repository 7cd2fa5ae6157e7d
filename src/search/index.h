// Exact neighbour search over points: FLANN's kd-tree proposes, chi_ball decides.
#pragma once

#include "search/search.h"

namespace psf::search {

// Facts about FLANN 1.9.2 that this class stands on: KDTreeSingleIndex is exact (KDTreeIndex is
// not); its pruning rounds, so it is asked for a slightly larger ball; NaN raises no error and an
// empty set is undefined, so both are kept from it; halves of coordinates beyond FLT_MAX / 2
// overflow in its splits, so sets with such points are searched by brute force.
class Index final : public Search {
 public:
  // Throws Error{limit} above 2^31 - 1 points. Non-finite coordinates are the caller's mistake.
  explicit Index(std::span<const Vec3> points);
  ~Index() override;

  void within(const Vec3& center, float r_sq, std::vector<Neighbor>& out) const override;
  void nearest(const Vec3& center, std::size_t k, std::vector<Neighbor>& out) const override;
  [[nodiscard]] std::size_t size() const override;

 private:
  struct Tree;
  void append_unreachable(std::size_t k, std::vector<Neighbor>& out) const;

  std::unique_ptr<Tree> tree_;
  std::unique_ptr<Search> scan_;  // instead of tree_, where FLANN cannot hold the points
};

}  // namespace psf::search
