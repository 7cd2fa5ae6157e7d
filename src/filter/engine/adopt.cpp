#include "filter/engine/adopt.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "filter/engine/refusal.h"

namespace psf::filter::engine {
namespace {

constexpr float kGrowth = 8;  // factor by which the squared radius grows
constexpr float kLeast = 1e-30f;

bool closer(const search::Neighbor& a, const search::Neighbor& b) {
  return a.d_sq != b.d_sq ? a.d_sq < b.d_sq : a.index < b.index;
}

// The sources nearest to record i that `test` passes, at most `count`.
template <class Test>
class Nearest {
 public:
  Nearest(const Tree& tree, const search::BoxIndex& index, std::span<const Vec3> x, std::uint32_t i,
          std::size_t count, const Test& test)
      : tree_(tree), index_(index), x_(x), at_{x[i], x[i]}, count_(count), test_(test) {}

  // Looks in balls from r_sq on. Sorted; index: the record's number.
  std::vector<search::Neighbor> find(float r_sq) {
    std::vector<std::uint32_t> nodes;
    for (;; r_sq *= kGrowth) {
      index_.within(at_, r_sq, nodes);
      const bool all = nodes.size() == tree_.nodes(kParents);
      r_sq_ = all ? std::numeric_limits<float>::infinity() : r_sq;
      found_.clear();
      for (const std::uint32_t node : nodes) look_into(node);
      if (all || found_.size() == count_) return std::move(found_);
    }
  }

 private:
  void look_into(std::size_t node) {
    if (test_.refuses(kParents, node)) return;
    const std::size_t end = std::min(tree_.nodes(kGroups), (node + 1) * kWidth);
    for (std::size_t group = node * kWidth; group < end; ++group) {
      const float gap_sq = search::gap_sq(at_, tree_.box(kGroups, group));
      if (!search::chi_ball(gap_sq, r_sq_) || (is_full() && gap_sq > found_.back().d_sq)) continue;
      if (test_.refuses(kGroups, group)) continue;
      for (std::size_t k = group * kWidth; k < std::min(tree_.size(), (group + 1) * kWidth); ++k) {
        consider(tree_.order()[k]);
      }
    }
  }
  void consider(std::uint32_t j) {
    const search::Neighbor candidate{j, search::distance_sq(at_.low, x_[j])};
    if (!search::chi_ball(candidate.d_sq, r_sq_)) return;
    if ((is_full() && !closer(candidate, found_.back())) || !test_.passes(j)) return;
    if (is_full()) found_.pop_back();
    found_.insert(std::upper_bound(found_.begin(), found_.end(), candidate, closer), candidate);
  }
  [[nodiscard]] bool is_full() const { return found_.size() == count_; }

  const Tree& tree_;
  const search::BoxIndex& index_;
  std::span<const Vec3> x_;
  search::Box at_;
  std::size_t count_;
  const Test& test_;
  float r_sq_ = 0;
  std::vector<search::Neighbor> found_;
};

// The weights of record i.
struct Weighted {
  const Problem& problem;
  std::uint32_t i;
  float r_i;
  Refusal refusal;

  [[nodiscard]] bool refuses(LevelName level, std::size_t node) const {
    return refusal.refuses(level, node);
  }
  [[nodiscard]] bool passes(std::uint32_t j) const { return problem.weights.pass(i, j, r_i); }
};

struct Unweighted {
  [[nodiscard]] static bool refuses(LevelName, std::size_t) { return false; }
  [[nodiscard]] static bool passes(std::uint32_t) { return true; }
};

}  // namespace

Adopted adopt(const Tree& tree, const search::BoxIndex& index, const Problem& problem,
              std::uint32_t i, float r_i) {
  const float r_sq = std::max(kLeast, kGrowth * r_i * r_i);
  const std::span<const Vec3> x = problem.records.position;
  const Weighted weighted = {problem, i, r_i, Refusal(tree, problem, i)};
  std::vector<search::Neighbor> nearest =
      Nearest(tree, index, x, i, kOrphanSources, weighted).find(r_sq);
  Adopted adopted;
  if (nearest.empty()) {
    adopted.matched = false;
    nearest = Nearest(tree, index, x, i, 1, Unweighted{}).find(r_sq);
  }
  for (const search::Neighbor& one : nearest) adopted.sources.push_back(one.index);
  return adopted;
}

}  // namespace psf::filter::engine
