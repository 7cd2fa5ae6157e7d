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
  require(agree > 0, "`agree`: a number of standard errors above 0");
  if (estimator == Estimator::hash) {
    require(!weights.plane,
            "`plane`: a plane is one record's, a cell of `estimator hash` has none; "
            "give `plane off`");
    require(iterations == 1,
            "`iterations`: what a cell of `estimator hash` shares does not change "
            "when it is averaged again; give 1");
    require(!count_refusals, "`refusals`: counts what is in balls, and `estimator hash` has none");
  }
  if (estimator == Estimator::control) {
    require(iterations == 1,
            "`iterations`: a half of `estimator control` has averages of the "
            "other's sources alone; give 1");
    require(!count_refusals,
            "`refusals`: the balls of `estimator control` hold halves; count with "
            "`estimator average`");
  }
}

std::vector<ChannelNeed> optional_channels(const Parameters& parameters) {
  std::vector<ChannelNeed> needs;
  const auto need = [&needs](bool wanted, std::string_view channel, std::string_view by,
                             std::string_view instead) {
    if (wanted) needs.push_back({channel, std::string(by), std::string(instead)});
  };
  const bool disk = parameters.estimator == Estimator::disk;
  const bool hash = parameters.estimator == Estimator::hash;
  const char* average = "give `estimator average`";
  for (std::size_t k = 0; k < kTermCount; ++k) {
    const auto term = static_cast<Term>(k);
    const TermInfo& of = info(term);
    if (!parameters.weights.on(term)) continue;
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
  need(disk, "normal", "`estimator disk`", average);
  need(hash, "normal", "`estimator hash`", average);
  need(parameters.demodulate, "reflectance", "`demodulate`", "leave `demodulate` out");
  need(disk, "direction", "`estimator disk`", average);
  return needs;
}

}  // namespace psf::filter
