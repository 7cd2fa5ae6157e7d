#include "filter/parameters/parameters.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "core/error.h"

namespace psf::filter {
namespace {

void require(bool holds, const std::string& message) {
  if (!holds) throw Error(ErrorCode::usage, message);
}

}  // namespace

WeightTerms WeightTerms::none() {
  WeightTerms terms;
  for (std::size_t k = 0; k < kTermCount; ++k) terms.switch_off(static_cast<Term>(k));
  return terms;
}

void WeightTerms::switch_off(Term term) {
  const TermInfo& of = info(term);
  if (of.threshold != nullptr) {
    (this->*of.threshold).reset();
  } else {
    this->*of.is_on = false;
  }
}

void Parameters::validate() const {
  require(std::isfinite(radius.r0) && radius.r0 >= 0, "`r0`: the radius must be finite and >= 0");
  require(radius.delta >= 0 && radius.delta < 1,
          "`delta`: must be in [0, 1); 0 keeps the radius fixed");
  require(block.base >= 2, "`block`: the base of b^m must be at least 2");
  require(block.exponent < 64, "`block`: the exponent of b^m must be below 64");
  require(block.passes >= 1, "`block`: at least one pass");
  for (const TermInfo& term : kTerms) {
    if (term.threshold == nullptr) continue;
    const std::optional<float>& t = weights.*term.threshold;  // NaN fails every comparison
    const bool holds =
        !t || (*t >= term.least && *t <= term.most && !(term.above && *t == term.least));
    require(holds, fmt::format("`{}`: {}", term.name, term.range));
  }
  require(iterations >= 1, "`iterations`: at least 1");
  require(sources >= 1, "`sources`: 1/K with K >= 1");
  require(
      fit == BallFit::mean || info(estimator).fits,
      fmt::format("`fit`: `estimator {}` is no mean over a ball that a fit could take the place "
                  "of; give `fit mean`",
                  info(estimator).name));
  require(fireflies.keeps() || info(estimator).fits,
          fmt::format("`fireflies`: what is ordinary in a ball is told by a mean over it, and "
                      "`estimator {}` is none; give `fireflies keep`",
                      info(estimator).name));
  require(fireflies.limit >= 1 && std::isfinite(fireflies.limit),
          "`fireflies`: the limit of clamp must be finite and at least 1");
  require(agree > 0, "`agree`: a number of standard errors above 0");
  for (const Refusal& refusal : info(estimator).refusals) {
    require(!refusal.applies(*this), std::string(refusal.message));
  }
}

std::vector<ChannelNeed> optional_channels(const Parameters& parameters) {
  std::vector<ChannelNeed> needs;
  const EstimatorInfo& estimator = info(parameters.estimator);
  for (std::size_t k = 0; k < kTermCount; ++k) {
    const auto term = static_cast<Term>(k);
    const TermInfo& of = info(term);
    if (!parameters.weights.on(term) || (estimator.terms & bit(term)) == 0) continue;
    // A switch is off without its option, but that which is on by default.
    const std::string instead = of.threshold != nullptr  ? "give `{} off`"
                                : WeightTerms().on(term) ? "give `{}=off`"
                                                         : "leave `{}` out";
    for (const std::string_view channel : of.channels) {
      if (channel.empty()) continue;
      needs.push_back({channel, fmt::format("`{}`", of.name),
                       fmt::format(fmt::runtime(instead), of.name), term});
    }
  }
  for (const std::string_view channel : estimator.channels) {
    if (channel.empty()) continue;
    needs.push_back(
        {channel, fmt::format("`estimator {}`", estimator.name), "give `estimator average`"});
  }
  if (parameters.fit == BallFit::linear) {
    needs.push_back({"normal", "`fit linear`", "give `fit mean`"});
  }
  if (parameters.demodulate) {
    needs.push_back({"reflectance", "`demodulate`", "leave `demodulate` out"});
  }
  return needs;
}

bool needs_distance(const Parameters& parameters) {
  return parameters.radius.basis != RadiusBasis::world || info(parameters.estimator).is_over_area;
}
bool needs_angle(const Parameters& parameters) {
  return parameters.radius.basis == RadiusBasis::footprint ||
         info(parameters.estimator).is_over_area;
}

}  // namespace psf::filter
