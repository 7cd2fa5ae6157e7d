#include "filter/estimators/density.h"

#include <limits>

#include "core/parallel.h"
#include "core/seconds.h"
#include "filter/inputs.h"

namespace psf::filter {
namespace {

constexpr std::size_t kDensityGrain = 4096;

bool is_finite_photon(const Photons& photons, std::size_t p) {
  return is_finite(photons.position[p]) && is_finite(photons.normal[p]) &&
         is_finite(photons.direction[p]) && is_finite(photons.power[p]);
}

// The terms, and that a photon arrives on the side of n_i: omega_p . n_i > 0. In the set of records
// and photons that is the term `direction`, where the direction of a record is its normal.
WeightTerms terms_of_set(const WeightTerms& asked) {
  WeightTerms terms = terms_of_photons(asked);
  terms.direction = std::numeric_limits<float>::denorm_min();
  return terms;
}

// The values of the records, and behind them those of the photons.
template <class T>
std::vector<T> joined(bool wanted, std::span<const T> records, std::span<const T> photons) {
  std::vector<T> all;
  if (!wanted) return all;
  all.reserve(records.size() + photons.size());
  all.insert(all.end(), records.begin(), records.end());
  all.insert(all.end(), photons.begin(), photons.end());
  return all;
}

// Queries are those of the records, which are no sources here; sources the finite photons.
Roles roles_of_set(const Records& records, const Roles& roles, Statistics& statistics) {
  const std::size_t first = records.size(), count = records.photons.position.size();
  Roles of_set;
  of_set.of.assign(first + count, Role::left_out);
  of_set.queries = roles.queries;
  for (const std::uint32_t i : roles.queries) of_set.of[i] = Role::query;
  of_set.sources.reserve(count);
  for (std::size_t p = 0; p < count; ++p) {
    if (!is_finite_photon(records.photons, p)) continue;
    of_set.of[first + p] = Role::source;
    of_set.sources.push_back(static_cast<std::uint32_t>(first + p));
  }
  statistics.photons += of_set.sources.size();
  statistics.photons_left_out += count - of_set.sources.size();
  return of_set;
}

}  // namespace

WeightTerms terms_of_photons(const WeightTerms& terms) {
  WeightTerms known = terms;
  for (std::size_t k = 0; k < kTermCount; ++k) {
    const auto term = static_cast<Term>(k);
    if ((info(Estimator::density).terms & bit(term)) == 0) known.switch_off(term);
  }
  return known;
}

PhotonProblem::PhotonProblem(const Records& records, const Roles& roles,
                             std::span<const float> radius, const WeightTerms& terms,
                             Statistics& statistics)
    : positions_(joined(true, records.position, records.photons.position)),
      normals_(joined(terms.normal || terms.plane, records.normal, records.photons.normal)),
      directions_(joined(true, records.normal, records.photons.direction)),
      materials_(joined(terms.material, records.material, records.photons.material)),
      powers_(records.size(), Rgb(0, 0, 0)),
      areas_(positions_.size(), static_cast<float>(1.0 / records.photons.passes)),
      roles_(roles_of_set(records, roles, statistics)),
      records_(view()),
      weights_(records_, terms_of_set(terms)),
      problem_{records_, roles_, radius, weights_, areas_, true} {
  powers_.insert(powers_.end(), records.photons.power.begin(), records.photons.power.end());
}

Records PhotonProblem::view() const {
  Records records;
  records.position = positions_;
  records.normal = normals_;
  records.direction = directions_;
  records.material = materials_;
  return records;
}

Estimates density(const MethodInput& input) {
  const Records& records = input.records;
  const Parameters& parameters = input.parameters;
  Estimates result;
  const auto start = core::Clock::now();
  Roles roles = find_roles(records, input.block, parameters, result.statistics);
  result.c_bar.assign(records.size(), Rgb(0, 0, 0));
  result.neighbors.assign(records.size(), 0);
  result.layers.resize(records.layers.size());  // photons have none
  const PhotonProblem photons(records, roles, input.radius, parameters.weights, result.statistics);
  if (photons.has_pairs()) {
    const std::unique_ptr<Engine> engine = ball_engine(photons.problem(), input.block, parameters);
    result.statistics.seconds_index = core::seconds_since(start);
    const Averaged sums{photons.values(), result.c_bar};
    engine->apply({&sums, 1}, BallFit::mean, parameters.count_refusals, result.neighbors,
                  result.statistics);
  } else {
    for (std::size_t k = 0; k < roles.queries.size(); ++k) result.statistics.add_query(0);
  }
  const std::span<const std::uint32_t> queries = roles.queries;
  core::parallel_for(queries.size(), kDensityGrain, [&](std::size_t begin, std::size_t end) {
    for (const std::uint32_t i : queries.subspan(begin, end - begin)) {
      result.c_bar[i] = finished(result.c_bar[i], result.neighbors[i], roles.of[i] == Role::source,
                                 input.radius[i], records.contribution[i], records, i, parameters);
    }
  });
  result.roles = std::move(roles.of);
  result.statistics.seconds_filter = core::seconds_since(start) - result.statistics.seconds_index;
  return result;
}

}  // namespace psf::filter
