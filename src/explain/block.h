// One block of an explanation: the sources that each of the pixel's paths averages or refuses.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "explain/explain.h"
#include "filter/estimate.h"
#include "filter/fireflies.h"
#include "filter/kinds.h"
#include "filter/orphans.h"
#include "filter/roles.h"
#include "filter/scaled.h"
#include "search/search.h"

namespace psf::explain {

// All record numbers count within the block, also in ExplainedPath::vertex and
// ExplainedPair::vertex.
class BlockExplainer {
 public:
  // Filters the whole block, as psf filter does. The records' columns and the parameters must
  // outlive the explainer.
  BlockExplainer(const filter::Records& records, const filter::Block& block,
                 const filter::Parameters& parameters);

  // Returns path i, and appends its pairs to `pairs`, ascending by source. Subtracts the pairs in
  // the ball from `room`, and throws Error{limit} where it falls below 0. Thread-safe.
  [[nodiscard]] ExplainedPath explain(std::uint32_t i, std::vector<ExplainedPair>& pairs,
                                      std::atomic<std::int64_t>& room) const;

  [[nodiscard]] bool is_source(std::uint32_t j) const {
    return estimates_.roles[j] == filter::Role::source;
  }
  // The value of source j that is averaged.
  [[nodiscard]] Rgb value(std::uint32_t j) const;
  // Record j as a firefly, if it is one.
  [[nodiscard]] std::optional<ExplainedFirefly> firefly(std::uint32_t j) const;

 private:
  // Vertices that are averaged together: of surfaces and curves, or in volumes.
  struct Kin {
    filter::Roles roles;                     // of all records, with the sources among these
    std::unique_ptr<search::Search> search;  // over the sources
  };

  void add_kin(bool in_volumes);
  [[nodiscard]] bool is_disk(std::uint32_t i) const;
  [[nodiscard]] PathFate fate_of(std::uint32_t i) const;
  [[nodiscard]] double scale_of(std::uint32_t i, std::span<const ExplainedPair> pairs) const;
  void find_pairs(std::uint32_t i, std::vector<ExplainedPair>& pairs,
                  std::atomic<std::int64_t>& room) const;
  void adopt(std::uint32_t i, std::vector<ExplainedPair>& pairs) const;
  void find_givers(std::uint32_t i, std::vector<ExplainedPair>& pairs,
                   std::atomic<std::int64_t>& room) const;
  void fit(ExplainedPath& path, std::span<ExplainedPair> pairs) const;
  // The pair of path i with source j, which is added where it is missing.
  ExplainedPair& pair_with(std::uint32_t i, std::uint32_t j,
                           std::vector<ExplainedPair>& pairs) const;

  const filter::Parameters& parameters_;
  filter::Estimates estimates_;
  std::vector<Rgb> before_;  // c_bar of the iteration before the last, without gifts
  std::vector<filter::Fireflies> fireflies_;    // of surfaces and volumes, where there are any
  std::vector<filter::Firefly> every_firefly_;  // of both, by record
  std::vector<float> radius_in_world_;          // r_i, as chosen, world units
  std::optional<filter::Scaled> scaled_;
  filter::Records records_;        // in the unit of scaled_
  std::span<const float> radius_;  // in the unit of scaled_
  std::optional<filter::KindWeights> weights_;
  std::vector<Kin> kin_;     // surfaces, and volumes where there are any
  std::vector<float> area_;  // A_j of [disk]
};

}  // namespace psf::explain
