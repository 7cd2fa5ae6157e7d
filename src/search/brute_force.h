// A search that tests every point; the oracle for the others.
#pragma once

#include "search/search.h"

namespace psf::search {

class BruteForce final : public Search {
 public:
  explicit BruteForce(std::span<const Vec3> points);

  void within(const Vec3& center, float r_sq, std::vector<Neighbor>& out) const override;
  void nearest(const Vec3& center, std::size_t k, std::vector<Neighbor>& out) const override;
  [[nodiscard]] std::size_t size() const override { return points_.size(); }

 private:
  std::vector<Vec3> points_;
};

}  // namespace psf::search
