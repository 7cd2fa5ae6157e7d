#include "filter/receivers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "filter/evenness.h"
#include "filter/lists.h"
#include "search/ball.h"
#include "search/search.h"

namespace psf::filter {
namespace {

// Measured in README.md, "Fireflies".
constexpr float kOneKind = 4;       // its kind is at least so many times less bright
constexpr std::size_t kOfKind = 4;  // R_j reaches so many others of its kind
constexpr float kFarthest = 4;      // R_j is at most so many r_j
constexpr float kNearest = 0.5f;    // and at least so many, but for what is dense:
constexpr float kDense = 2;         // at most so many distances to the last of its kind

constexpr float kHair = 1 + 1e-6f;  // so that the last of its kind is within R_j

constexpr std::size_t kReachGrain = 64;

bool is_of_kind(float other, float y) {
  return double{kOneKind} * double{other} >= double{y};
}

// t_j^2, from the squared distances of its kind; infinite where they are too few.
float fourth(std::vector<float>& squares) {
  if (squares.size() < kOfKind) return std::numeric_limits<float>::infinity();
  const auto last = squares.begin() + (kOfKind - 1);
  std::nth_element(squares.begin(), last, squares.end());
  return *last;
}

float reach_of(float fourth_sq, float r_j) {
  const float last = kHair * std::sqrt(fourth_sq);
  return std::min(std::max(last, std::min(kNearest * r_j, kDense * last)), kFarthest * r_j);
}

class Finder {
 public:
  Finder(const Problem& problem, EngineKind engine, std::vector<Firefly>& bright)
      : p_(problem),
        engine_(engine),
        bright_(bright),
        receivers_(bright.size()),
        luminance_(problem.records.size(), kOrdinary) {
    for (const Firefly& one : bright) luminance_[one.record] = one.luminance;
  }

  // Those that have enough of their kind within kEvenRadius r_j. Returns the places of the others.
  [[nodiscard]] std::vector<std::uint32_t> find_dense() {
    std::vector<std::uint32_t> centers;
    std::vector<float> around;
    for (const Firefly& one : bright_) {
      centers.push_back(one.record);
      around.push_back(kEvenRadius * p_.radius[one.record]);
    }
    std::vector<std::uint8_t> is_sparse(bright_.size());
    make_lists(engine_, p_, centers, around)->each([&](std::size_t g, auto near) {
      const std::uint32_t j = centers[g];
      std::vector<float> kind;
      for (const std::uint32_t i : near) {
        if (is_of_kind(luminance_[i], luminance_[j])) kind.push_back(distance_sq(i, j));
      }
      is_sparse[g] = kind.size() < kOfKind ? 1 : 0;
      if (is_sparse[g] != 0 || is_even(j, around[g], near)) return;
      bright_[g].reach = reach_of(fourth(kind), p_.radius[j]);
      take(g, near);
    });
    std::vector<std::uint32_t> places;
    for (std::uint32_t g = 0; g < is_sparse.size(); ++g) {
      if (is_sparse[g] != 0) places.push_back(g);
    }
    return places;
  }

  void find_sparse(std::span<const std::uint32_t> places) {
    find_reaches(places);
    std::vector<std::uint32_t> centers;
    std::vector<float> reach;
    for (const std::uint32_t g : places) {
      centers.push_back(bright_[g].record);
      reach.push_back(bright_[g].reach);
    }
    make_lists(engine_, p_, centers, reach)->each([&](std::size_t k, auto near) {
      take(places[k], near);
    });
  }

  // Of all but those that have none, which it leaves out.
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> receivers() && {
    std::size_t left = 0;
    for (std::size_t g = 0; g < bright_.size(); ++g) {
      if (receivers_[g].empty()) continue;
      bright_[left] = bright_[g];
      std::swap(receivers_[left++], receivers_[g]);
    }
    bright_.resize(left);
    receivers_.resize(left);
    return std::move(receivers_);
  }

 private:
  static constexpr float kOrdinary = -1;  // of no kind

  [[nodiscard]] float distance_sq(std::uint32_t i, std::uint32_t j) const {
    return search::distance_sq(p_.records.position[i], p_.records.position[j]);
  }

  [[nodiscard]] bool is_even(std::uint32_t j, float radius,
                             std::span<const std::uint32_t> near) const {
    Evenness evenness(radius);
    for (const std::uint32_t i : near) {
      if (p_.roles.of[i] != Role::source) continue;
      evenness.add(p_.records.position[i] - p_.records.position[j],
                   is_of_kind(luminance_[i], luminance_[j]));
    }
    return evenness.is_even();
  }

  // R_j where it is not known yet.
  void find_reaches(std::span<const std::uint32_t> places) {
    std::vector<Vec3> positions;
    for (const Firefly& one : bright_) positions.push_back(p_.records.position[one.record]);
    const std::unique_ptr<search::Search> search =
        search::make_search(search_of(engine_), positions);
    core::parallel_for(places.size(), kReachGrain, [&](std::size_t begin, std::size_t end) {
      core::throw_if_interrupted("no picture was written");
      std::vector<search::Neighbor> found;
      std::vector<float> kind;
      for (std::size_t k = begin; k < end; ++k) {
        const std::uint32_t g = places[k], j = bright_[g].record;
        const float farthest = kFarthest * p_.radius[j];
        search->within(p_.records.position[j], farthest * farthest, found);
        kind.clear();
        for (const search::Neighbor& near : found) {
          const std::uint32_t i = bright_[near.index].record;
          if (i == j || !is_of_kind(luminance_[i], luminance_[j]) || !p_.alike(i, j)) continue;
          kind.push_back(near.d_sq);
        }
        bright_[g].reach = reach_of(fourth(kind), p_.radius[j]);
      }
    });
  }

  // `near`: what is alike around the bright one at place g, as far as R_j or farther.
  void take(std::size_t g, std::span<const std::uint32_t> near) {
    const std::uint32_t j = bright_[g].record;
    const float reach = bright_[g].reach;
    std::vector<std::uint32_t>& of = receivers_[g];
    of.push_back(j);
    std::uint64_t sources = 1;  // N_j: as in a mean, sources stand for the queries around them
    for (const std::uint32_t i : near) {
      if (!search::chi_ball(distance_sq(i, j), reach * reach)) continue;
      of.push_back(i);
      if (p_.roles.of[i] == Role::source) ++sources;
    }
    bright_[g].per_source = 1 / static_cast<double>(sources);
  }

  const Problem& p_;
  EngineKind engine_;
  std::vector<Firefly>& bright_;
  std::vector<std::vector<std::uint32_t>> receivers_;
  std::vector<float> luminance_;  // by record number, of those that are bright
};

}  // namespace

std::vector<std::vector<std::uint32_t>> find_receivers(const Problem& problem, EngineKind engine,
                                                       std::vector<Firefly>& bright) {
  Finder finder(problem, engine, bright);
  finder.find_sparse(finder.find_dense());
  return std::move(finder).receivers();
}

}  // namespace psf::filter
