#include "search/index.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <flann/flann.hpp>
#include <limits>

#include "core/error.h"
#include "search/brute_force.h"

namespace psf::search {
namespace {

constexpr float kLargestCoordinate = std::numeric_limits<float>::max() / 4;

// FLANN's pruning adds up squared distances along the path from the root: two roundings a level,
// and at most about 800 levels, since every split halves the span of one axis or the set.
constexpr float kEnlargeSquare = 1.001f;
// Roundings of denormal numbers are absolute, not relative.
constexpr float kEnlargeSquareBy = 1e-36f;

// The squared distance that FLANN is told to look up to. It adds two such numbers before it
// subtracts a third, so near the largest float it would prune by an infinity that is none: there it
// must not prune.
float proposal(float r_sq) {
  constexpr float kLargest = std::numeric_limits<float>::max() / 8;
  return r_sq > kLargest ? std::numeric_limits<float>::infinity()
                         : r_sq * kEnlargeSquare + kEnlargeSquareBy;
}

// FLANN measures with our definition, so what it hands us needs no second look at the point.
struct BallDistance {
  using is_kdtree_distance = bool;  // NOLINT(readability-identifier-naming): FLANN asks for it
  using ElementType = float;
  using ResultType = float;

  float operator()(const float* a, const float* b, std::size_t, float = -1) const {
    return distance_sq(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  }
  float accum_dist(float a, float b, int) const { return (a - b) * (a - b); }
};

using FlannTree = flann::KDTreeSingleIndex<BallDistance>;
using FlannResults = flann::ResultSet<float>;

class BallResults final : public FlannResults {
 public:
  BallResults(float r_sq, std::vector<Neighbor>& out)
      : r_sq_(r_sq), proposed_(proposal(r_sq)), out_(out) {}
  bool full() const override { return true; }
  float worstDist() const override { return proposed_; }
  void addPoint(float d_sq, std::size_t index) override {
    if (chi_ball(d_sq, r_sq_)) out_.push_back({static_cast<std::uint32_t>(index), d_sq});
  }

 private:
  float r_sq_, proposed_;
  std::vector<Neighbor>& out_;
};

// Keeps the k smallest squared distances as a heap: it is the reach of the k nearest that counts
// here, since FLANN breaks ties by its leaf order.
class ReachResults final : public FlannResults {
 public:
  explicit ReachResults(std::size_t k) : k_(k) { heap_.reserve(k); }
  bool full() const override { return heap_.size() == k_; }
  float worstDist() const override { return proposal(reach()); }
  // The k-th smallest squared distance so far, infinity while there are fewer.
  [[nodiscard]] float reach() const {
    return full() ? heap_.front() : std::numeric_limits<float>::infinity();
  }
  void addPoint(float d_sq, std::size_t) override {
    if (full()) {
      if (d_sq >= heap_.front()) return;
      std::pop_heap(heap_.begin(), heap_.end());
      heap_.back() = d_sq;
    } else {
      heap_.push_back(d_sq);
    }
    std::push_heap(heap_.begin(), heap_.end());
  }

 private:
  std::size_t k_;
  std::vector<float> heap_;
};

bool fits(std::span<const Vec3> points) {
  return std::all_of(points.begin(), points.end(), [](const Vec3& p) {
    assert(is_finite(p));
    return std::abs(p.x) <= kLargestCoordinate && std::abs(p.y) <= kLargestCoordinate &&
           std::abs(p.z) <= kLargestCoordinate;
  });
}

}  // namespace

struct Index::Tree {
  explicit Tree(std::span<const Vec3> points)
      : count(points.size()), coordinates(points.begin(), points.end()), flann(parameters()) {
    static_assert(sizeof(Vec3) == 3 * sizeof(float), "FLANN reads the points as rows of 3 floats");
    flann.buildIndex(flann::Matrix<float>(&coordinates[0].x, count, 3));
    // The tree holds a copy in its own order; from here on it never looks at the rows again.
    coordinates = {};
  }
  void search(const Vec3& center, FlannResults& results) const {
    const float query[3] = {center.x, center.y, center.z};
    flann.findNeighbors(results, query, flann::SearchParams());
  }
  static flann::IndexParams parameters() { return flann::KDTreeSingleIndexParams(); }

  std::size_t count;
  std::vector<Vec3> coordinates;
  FlannTree flann;
};

Index::Index(std::span<const Vec3> points) {
  if (points.size() > std::size_t{std::numeric_limits<std::int32_t>::max()}) {
    throw Error(ErrorCode::limit,
                "a block of more than 2147483647 records cannot be searched; "
                "filter in smaller blocks");
  }
  if (points.empty() || !fits(points)) {
    scan_ = std::make_unique<BruteForce>(points);
  } else {
    tree_ = std::make_unique<Tree>(points);
  }
}

Index::~Index() = default;

std::size_t Index::size() const {
  return tree_ ? tree_->count : scan_->size();
}

void Index::within(const Vec3& center, float r_sq, std::vector<Neighbor>& out) const {
  if (!tree_) return scan_->within(center, r_sq, out);
  out.clear();
  if (!(r_sq > 0)) return;
  BallResults results(r_sq, out);
  tree_->search(center, results);
}

void Index::nearest(const Vec3& center, std::size_t k, std::vector<Neighbor>& out) const {
  if (!tree_) return scan_->nearest(center, k, out);
  out.clear();
  k = std::min(k, tree_->count);
  if (k == 0) return;
  ReachResults nearest(k);
  tree_->search(center, nearest);
  // All points as near as the k-th, so that ties are broken by index and not by FLANN's order.
  const float r_sq = std::nextafter(nearest.reach(), std::numeric_limits<float>::infinity());
  BallResults results(r_sq, out);
  tree_->search(center, results);
  const auto closer = [](const Neighbor& a, const Neighbor& b) {
    return a.d_sq != b.d_sq ? a.d_sq < b.d_sq : a.index < b.index;
  };
  std::sort(out.begin(), out.end(), closer);
  if (out.size() > k) out.resize(k);
  if (out.size() < k) append_unreachable(k, out);
}

// Points whose squared distance overflows are all equally far; FLANN leaves them out.
void Index::append_unreachable(std::size_t k, std::vector<Neighbor>& out) const {
  std::vector<bool> found(tree_->count);
  for (const Neighbor& neighbor : out) found[neighbor.index] = true;
  for (std::uint32_t index = 0; out.size() < k; ++index) {
    if (!found[index]) out.push_back({index, std::numeric_limits<float>::infinity()});
  }
}

}  // namespace psf::search
