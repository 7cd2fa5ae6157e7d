// The vertices of one frame that ask and those of another that answer, as one set for the engines.
#pragma once

#include <span>
#include <vector>

#include "filter/parameters/parameters.h"
#include "filter/records.h"
#include "filter/roles.h"
#include "filter/statistics.h"

namespace psf::filter {

// A frame as a pair sees it: its records, and who of them takes part.
struct FrameSide {
  const Records& records;
  const Roles& roles;
};

// The records of the frame that asks come first, those of the other behind them; places are those
// at rest where `rest` is set.
class FramePair {
 public:
  // `asks.roles.queries` ask, `gives.roles.sources` answer; both lists are not empty. `radius`: of
  // the records that ask, world units. `terms` may be without those that no record needs.
  FramePair(const FrameSide& asks, const FrameSide& gives, std::span<const float> radius,
            const WeightTerms& terms, bool rest);

  // Values by record of the frame that answers, by their number in the set.
  [[nodiscard]] std::vector<Rgb> behind_queries(std::span<const Rgb> of_gives) const;

  // Writes the mean of each of `values` over the sources in the ball of every query to `means`, by
  // value and record that asks, and the number of these sources, with 0 for none. The result is the
  // same for any number of threads. Throws Error{interrupted} on ^C.
  void average(std::span<const std::vector<Rgb>> values, EngineKind engine,
               std::span<std::vector<Rgb>> means, std::span<std::uint32_t> neighbors) const;

 private:
  [[nodiscard]] Records view() const;

  std::size_t first_;  // records that ask
  WeightTerms terms_;
  std::vector<std::uint8_t> flags_;
  std::vector<Vec3> positions_, normals_, directions_;
  std::vector<Rgb> reflectances_;
  std::vector<std::uint32_t> visibilities_, materials_;
  std::vector<float> hit_distances_, roughnesses_, radii_;
  Roles roles_;
};

}  // namespace psf::filter
