// The interface of every neighbour search, so that one can replace another.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "search/ball.h"

namespace psf::search {

// Searches are const and share no state: any number of threads may search at once, each with its
// own `out`, which is cleared first and keeps its capacity.
class Search {
 public:
  virtual ~Search() = default;

  // Finds every point with chi_ball(distance_sq(point, center), r_sq), duplicates included, in an
  // order that depends on the points alone. r_sq <= 0 finds nothing, infinity finds every point at
  // a finite squared distance.
  virtual void within(const Vec3& center, float r_sq, std::vector<Neighbor>& out) const = 0;

  // Finds the min(k, size()) nearest points, nearest first; the lower index wins ties.
  virtual void nearest(const Vec3& center, std::size_t k, std::vector<Neighbor>& out) const = 0;

  [[nodiscard]] virtual std::size_t size() const = 0;
};

enum class Kind {
  flann,
  brute  // tests every point: the oracle
};

// `points` are copied; their coordinates must be finite. Throws Error{limit} above 2^31 - 1 points.
[[nodiscard]] std::unique_ptr<Search> make_search(Kind kind, std::span<const Vec3> points);

}  // namespace psf::search
