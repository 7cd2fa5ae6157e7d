#include "filter/estimate.h"

#include <array>
#include <optional>
#include <utility>

#include "filter/estimators/adaptive.h"
#include "filter/estimators/average.h"
#include "filter/estimators/control.h"
#include "filter/estimators/density.h"
#include "filter/estimators/disk.h"
#include "filter/estimators/hash.h"
#include "filter/fireflies.h"
#include "filter/inputs.h"
#include "filter/kinds.h"
#include "filter/scaled.h"

namespace psf::filter {
namespace {

// By the value of Estimator.
constexpr std::array kMethods = {average, disk, hash, control, adaptive, density};
static_assert(kMethods.size() == kEstimatorCount);

}  // namespace

Estimates estimate(const Records& records, std::span<const float> radius, const Block& block,
                   const Parameters& parameters, std::vector<Fireflies>* fireflies) {
  parameters.validate();
  require_channels(records, parameters);
  if (has_kinds_apart(records)) {
    const std::vector<KindRun> runs = runs_of_kinds(records, parameters);
    Estimates result = estimate(runs[0].records, radius, block, runs[0].parameters, fireflies);
    merge_volumes(records, radius, result,
                  estimate(runs[1].records, radius, block, runs[1].parameters, fireflies));
    return result;
  }
  const Scaled scaled(records, radius, info(parameters.estimator).least_share);
  const Method method = kMethods[static_cast<std::size_t>(parameters.estimator)];
  std::optional<Fireflies> found;
  Estimates result = method({scaled.records(), scaled.radius(), block, parameters,
                             fireflies != nullptr ? &found : nullptr});
  if (found) {
    found->to_world(scaled);
    fireflies->push_back(std::move(*found));
  }
  for (float& r_i : result.radius) r_i = scaled.to_world(r_i);
  return result;
}

}  // namespace psf::filter
