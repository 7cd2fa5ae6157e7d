// Vertices in volumes and all others, which a block filters apart: README.md, "Kinds".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/estimate.h"
#include "filter/parameters/parameters.h"
#include "filter/records.h"
#include "filter/weights.h"

namespace psf::filter {

// Whether a vertex of the records is in a volume and `taken` does not say which are meant.
[[nodiscard]] bool has_kinds_apart(const Records& records);

// Of the terms those that mean something in a volume.
[[nodiscard]] WeightTerms terms_in_volumes(const WeightTerms& terms);

// A run over some of the vertices.
struct KindRun {
  Records records;
  Parameters parameters;
};
// The two runs whose results are those of the block: surfaces and curves, then volumes. There
// surface terms are off, and estimators that know surfaces alone are [average].
[[nodiscard]] std::vector<KindRun> runs_of_kinds(const Records& records,
                                                 const Parameters& parameters);

// Puts the results of the vertices in volumes beside those of the others. `given`: the radii of the
// records, for vertices whose run has chosen none.
void merge_volumes(const Records& records, std::span<const float> given, Estimates& result,
                   Estimates&& volumes);
// The same of roles alone.
void merge_volumes(const Records& records, std::vector<Role>& roles, std::span<const Role> volumes);

// w_ij of any two vertices, for those who look at pairs one by one.
class KindWeights {
 public:
  KindWeights(const Records& records, const WeightTerms& terms)
      : records_(records), surfaces_(records, terms), volumes_(records, terms_in_volumes(terms)) {}

  // The bit of a pair of which one vertex is in a volume and the other is not.
  static constexpr std::uint32_t kApart = std::uint32_t{1} << kTermCount;

  // What refuses the pair: terms, bit k that of value k, and kApart.
  [[nodiscard]] std::uint32_t refusers(std::uint32_t i, std::uint32_t j, float r_i) const {
    const bool of_i = records_.in_volume(i), of_j = records_.in_volume(j);
    const Weights& weights = of_i || of_j ? volumes_ : surfaces_;
    return weights.refusers(i, j, r_i) | (of_i == of_j ? 0 : kApart);
  }
  [[nodiscard]] bool pass(std::uint32_t i, std::uint32_t j, float r_i) const {
    return refusers(i, j, r_i) == 0;
  }
  // Of pairs of two vertices like i.
  [[nodiscard]] const Weights& like(std::uint32_t i) const {
    return records_.in_volume(i) ? volumes_ : surfaces_;
  }

 private:
  Records records_;
  Weights surfaces_, volumes_;
};

}  // namespace psf::filter
