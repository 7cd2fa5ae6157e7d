#include "filter/parameters.h"

#include <cmath>

#include "core/error.h"

namespace psf::filter {
namespace {

void require(bool holds, const char* message) {
  if (!holds) throw Error(ErrorCode::usage, message);
}

// NaN fails both.
bool at_least_zero(const std::optional<float>& t) {
  return !t || *t >= 0;
}
bool is_cosine(const std::optional<float>& t) {
  return !t || (*t >= -1 && *t <= 1);
}

}  // namespace

WeightTerms WeightTerms::none() {
  WeightTerms terms;
  terms.normal.reset();
  terms.reflectance.reset();
  terms.visibility = false;
  terms.gloss.reset();
  return terms;
}

void WeightTerms::switch_off(std::size_t term) {
  switch (term) {
    case 0:
      return normal.reset();
    case 1:
      return reflectance.reset();
    case 2:
      visibility = false;
      return;
    case 3:
      return hit_distance.reset();
    case 4:
      return plane.reset();
    case 5:
      return direction.reset();
    case 6:
      material = false;
      return;
    default:
      gloss.reset();
  }
}

void Parameters::validate() const {
  require(std::isfinite(radius.r0) && radius.r0 >= 0, "--r0: the radius must be finite and >= 0");
  require(radius.delta >= 0 && radius.delta < 1,
          "--delta: must be in [0, 1); 0 keeps the radius fixed");
  require(block.base >= 2, "--block: the base of b^m must be at least 2");
  require(block.exponent < 64, "--block: the exponent of b^m must be below 64");
  require(block.passes >= 1, "--block: at least one pass");
  require(is_cosine(weights.normal), "--normal: the threshold is a cosine in [-1, 1]");
  require(at_least_zero(weights.reflectance), "--reflectance: the threshold must be >= 0");
  require(at_least_zero(weights.hit_distance), "--hit-distance: the threshold must be >= 0");
  require(at_least_zero(weights.plane), "--plane: the threshold must be >= 0");
  require(is_cosine(weights.direction), "--direction: the threshold is a cosine in [-1, 1]");
  require(!weights.gloss || *weights.gloss > 0, "--gloss: the threshold must be > 0");
  require(iterations >= 1, "--iterations: at least 1");
  require(sources >= 1, "--sources: 1/K with K >= 1");
  require(agree > 0, "--agree: a number of standard errors above 0");
  if (estimator == Estimator::hash) {
    require(!weights.plane,
            "--plane: a plane is one record's, a cell of --estimator hash has none; "
            "give --plane off");
    require(iterations == 1,
            "--iterations: what a cell of --estimator hash shares does not change "
            "when it is averaged again; give 1");
    require(!count_refusals, "--refusals: counts what is in balls, and --estimator hash has none");
  }
  if (estimator == Estimator::control) {
    require(iterations == 1,
            "--iterations: a half of --estimator control has averages of the "
            "other's sources alone; give 1");
    require(!count_refusals,
            "--refusals: the balls of --estimator control hold halves; count with --estimator "
            "average");
  }
}

std::vector<ChannelNeed> optional_channels(const Parameters& parameters) {
  std::vector<ChannelNeed> needs;
  const auto need = [&needs](bool wanted, std::string_view channel, std::string_view by,
                             std::string_view instead) {
    if (wanted) needs.push_back({channel, by, instead});
  };
  const WeightTerms& weights = parameters.weights;
  const bool disk = parameters.estimator == Estimator::disk;
  const bool hash = parameters.estimator == Estimator::hash;
  const char* average = "give --estimator average";
  need(weights.normal.has_value(), "normal", "--normal", "give --normal off");
  need(weights.plane.has_value(), "normal", "--plane", "give --plane off");
  need(disk, "normal", "--estimator disk", average);
  need(hash, "normal", "--estimator hash", average);
  need(weights.reflectance.has_value(), "reflectance", "--reflectance", "give --reflectance off");
  need(parameters.demodulate, "reflectance", "--demodulate", "leave --demodulate out");
  need(weights.visibility, "visibility", "--visibility", "give --visibility=off");
  need(weights.hit_distance.has_value(), "hit_distance", "--hit-distance",
       "give --hit-distance off");
  need(weights.direction.has_value(), "direction", "--direction", "give --direction off");
  need(disk, "direction", "--estimator disk", average);
  need(weights.material, "material", "--material", "leave --material out");
  need(weights.gloss.has_value(), "normal", "--gloss", "give --gloss off");
  need(weights.gloss.has_value(), "direction", "--gloss", "give --gloss off");
  need(weights.gloss.has_value(), "roughness", "--gloss", "give --gloss off");
  return needs;
}

}  // namespace psf::filter
