// [density]: photon mapping's estimate, of the photons in the ball over the area of its disk.
#pragma once

#include <span>
#include <vector>

#include "filter/estimators/method.h"

namespace psf::filter {

// The terms of w_ij that photons can answer for.
[[nodiscard]] WeightTerms terms_of_photons(const WeightTerms& terms);

// The records of a block, and behind them its photons, as one set: of the records come the queries,
// and the finite photons are the sources. So every engine finds photons as it finds records.
class PhotonProblem {
 public:
  // `roles` and `radius` are the records', and borrowed as they are. Counts photons.
  PhotonProblem(const Records& records, const Roles& roles, std::span<const float> radius,
                const WeightTerms& terms, Statistics& statistics);
  PhotonProblem(const PhotonProblem&) = delete;
  PhotonProblem& operator=(const PhotonProblem&) = delete;

  // Whether there are queries and photons; where there are not, no engine takes the problem.
  [[nodiscard]] bool has_pairs() const {
    return !roles_.queries.empty() && !roles_.sources.empty();
  }
  // [disk] of the values, which are powers, is [density] without the BSDF.
  [[nodiscard]] const Problem& problem() const { return problem_; }
  [[nodiscard]] std::span<const Rgb> values() const { return powers_; }

 private:
  [[nodiscard]] Records view() const;

  std::vector<Vec3> positions_, normals_, directions_;
  std::vector<std::uint32_t> materials_;
  std::vector<Rgb> powers_;
  std::vector<float> areas_;  // 1/P
  Roles roles_;
  Records records_;  // what the terms and the searches look at
  Weights weights_;
  Problem problem_;
};

[[nodiscard]] Estimates density(const MethodInput& input);

}  // namespace psf::filter
