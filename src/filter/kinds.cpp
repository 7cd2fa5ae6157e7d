#include "filter/kinds.h"

#include <algorithm>
#include <utility>

namespace psf::filter {

bool has_kinds_apart(const Records& records) {
  if (records.taken != Taken::all) return false;
  for (std::size_t i = 0; i < records.kind.size(); ++i) {
    if (records.in_volume(i) && (records.flags[i] & kHasVertex) != 0) return true;
  }
  return false;
}

WeightTerms terms_in_volumes(const WeightTerms& terms) {
  WeightTerms some = terms;
  for (const Term term :
       {Term::normal, Term::reflectance, Term::plane, Term::direction, Term::gloss}) {
    some.switch_off(term);
  }
  return some;
}

std::vector<KindRun> runs_of_kinds(const Records& records, const Parameters& parameters) {
  std::vector<KindRun> runs(2, {records, parameters});
  runs[0].records.taken = Taken::surfaces;
  runs[1].records.taken = Taken::volumes;
  Parameters& of_volumes = runs[1].parameters;
  of_volumes.weights = terms_in_volumes(parameters.weights);
  const EstimatorInfo& estimator = info(parameters.estimator);
  if (estimator.is_over_area || estimator.is_of_photons) of_volumes.estimator = Estimator::average;
  return runs;
}

void merge_volumes(const Records& records, std::vector<Role>& roles,
                   std::span<const Role> volumes) {
  for (std::size_t i = 0; i < roles.size(); ++i) {
    if ((records.flags[i] & kHasVertex) != 0 && records.in_volume(i)) roles[i] = volumes[i];
  }
}

void merge_volumes(const Records& records, std::span<const float> given, Estimates& result,
                   Estimates&& volumes) {
  const auto take = [&records](auto& to, const auto& from) {
    for (std::size_t i = 0; i < to.size() && i < from.size(); ++i) {
      if (records.in_volume(i)) to[i] = from[i];
    }
  };
  merge_volumes(records, result.roles, volumes.roles);
  take(result.c_bar, volumes.c_bar);
  take(result.neighbors, volumes.neighbors);
  for (std::size_t k = 0; k < result.layers.size(); ++k) take(result.layers[k], volumes.layers[k]);
  if (result.radius.empty() && !volumes.radius.empty()) {
    result.radius.assign(given.begin(), given.end());
  }
  if (result.given.empty() && !volumes.given.empty()) {
    result.given.assign(records.size(), Rgb(0, 0, 0));
  }
  take(result.given, volumes.given);
  take(result.radius, volumes.radius);
  result.statistics += volumes.statistics;
}

}  // namespace psf::filter
