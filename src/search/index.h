// Exact neighbour search over points: FLANN's kd-tree proposes, chi_ball decides.
#pragma once

#include "search/search.h"

namespace psf::search {

// This class relies on these facts about FLANN 1.9.2: KDTreeSingleIndex is exact (KDTreeIndex is
// not). Its pruning rounds, so it is asked for a slightly larger ball. It raises no error for NaN
// and is undefined for an empty set, so it is given neither. Coordinates beyond FLT_MAX / 2
// overflow in its splits, so sets with such points are searched by brute force.
class Index final : public Search {
 public:
  // Coordinates must be finite. Throws Error{limit} above 2^31 - 1 points.
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
