// What every neighbour search answers, so that one can stand in for another.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "search/ball.h"

namespace psf::search {

// Const and without shared state: any number of threads may ask at once, each with its own `out`,
// which is cleared first and keeps its capacity.
class Search {
 public:
  virtual ~Search() = default;

  // Every point with chi_ball(distance_sq(point, center), r_sq), duplicates included, in an order
  // that depends on the points alone. r_sq <= 0 finds nothing, infinity every point at a finite
  // squared distance.
  virtual void within(const Vec3& center, float r_sq, std::vector<Neighbor>& out) const = 0;

  // The min(k, size()) nearest points, nearest first, ties by the lower index.
  virtual void nearest(const Vec3& center, std::size_t k, std::vector<Neighbor>& out) const = 0;

  [[nodiscard]] virtual std::size_t size() const = 0;
};

enum class Kind {
  flann,  // FLANN over groups of points: the fast engine of filter/
  plain,  // FLANN, one search a query
  brute   // every point is tested: the oracle
};

// `points`: finite coordinates, at most 2^31 - 1 of them (else Error{limit}); copied.
[[nodiscard]] std::unique_ptr<Search> make_search(Kind kind, std::span<const Vec3> points);

}  // namespace psf::search
