#include "filter/average.h"

#include <memory>

#include "core/error.h"
#include "core/parallel.h"
#include "core/seconds.h"
#include "filter/estimators/adaptive.h"
#include "filter/estimators/control.h"
#include "filter/estimators/hash.h"
#include "filter/inputs.h"
#include "filter/problem.h"
#include "filter/radius.h"
#include "filter/scaled.h"

namespace psf::filter {
namespace {

constexpr std::size_t kQueriesARange = 4096;

using core::Clock;
using core::seconds_since;

// Applies finished() to the average of every query.
void finish(const Records& records, const Roles& roles, std::span<const float> radius,
            const Parameters& parameters, Average& result) {
  const std::span<const std::uint32_t> queries = roles.queries;
  core::parallel_for(queries.size(), kQueriesARange, [&](std::size_t begin, std::size_t end) {
    for (const std::uint32_t i : queries.subspan(begin, end - begin)) {
      result.c_bar[i] = finished(result.c_bar[i], result.neighbors[i], roles.of[i] == Role::source,
                                 radius[i], records, i, parameters);
    }
  });
}

std::unique_ptr<Engine> engine_of(const Problem& problem, const Block& block,
                                  const Parameters& parameters) {
  if (parameters.estimator != Estimator::hash) return make_engine(parameters.engine, problem);
  // Where r0 is 0 no record has a cell, and any scale does.
  const double scale = radius_scale(parameters.radius, block.n);
  return make_hash(parameters.engine, problem, scale > 0 ? scale : 1, block.first_path);
}

void leave_out_queries(Average& result) {
  for (Role& role : result.roles) {
    if (role == Role::query) role = Role::left_out;
  }
  result.statistics.without_source = result.statistics.queries;
}

// In a unit in which squares are floats.
Average average_scaled(const Records& records, std::span<const float> radius, const Block& block,
                       const Parameters& parameters) {
  if (parameters.estimator == Estimator::control) {
    return control(records, radius, block, parameters);
  }
  Average result;
  const auto start = Clock::now();
  Roles roles = find_roles(records, block, parameters, result.statistics);
  result.c_bar.assign(records.size(), Rgb(0, 0, 0));
  result.neighbors.assign(records.size(), 0);
  if (roles.sources.empty()) {
    result.roles = std::move(roles.of);
    leave_out_queries(result);
    return result;
  }
  const bool disk = parameters.estimator == Estimator::disk;
  const std::vector<float> area = disk ? areas(records, roles, block) : std::vector<float>();
  const Weights weights(records, terms_in_use(records, parameters.weights));
  std::vector<Rgb> previous;
  if (parameters.demodulate) previous = demodulated(records, roles);
  const std::span<const Rgb> values = parameters.demodulate ? previous : records.contribution;
  if (parameters.estimator == Estimator::adaptive) {
    result.radius = adaptive_radii(parameters.engine, {records, roles, radius, weights, {}}, values,
                                   parameters.agree);
    radius = result.radius;
  }
  const Problem problem{records, roles, radius, weights, area};
  const std::unique_ptr<Engine> engine = engine_of(problem, block, parameters);
  result.statistics.seconds_index = seconds_since(start);

  const auto filter_start = Clock::now();
  engine->average(values, parameters.count_refusals, result.c_bar, result.neighbors,
                  result.statistics);
  for (std::uint32_t k = 1; k < parameters.iterations; ++k) {
    std::swap(previous, result.c_bar);
    result.c_bar.resize(records.size(), Rgb(0, 0, 0));
    Statistics repeated;  // the same neighbours: counted once
    engine->average(previous, false, result.c_bar, result.neighbors, repeated);
  }
  finish(records, roles, radius, parameters, result);
  result.roles = std::move(roles.of);
  result.statistics.seconds_filter = seconds_since(filter_start);
  return result;
}

}  // namespace

Average average(const Records& records, std::span<const float> radius, const Block& block,
                const Parameters& parameters) {
  parameters.validate();
  require_channels(records, parameters);
  const bool adaptive = parameters.estimator == Estimator::adaptive;
  const Scaled scaled(records, radius, adaptive ? kAdaptiveLeastShare : 1);
  Average result = average_scaled(scaled.records(), scaled.radius(), block, parameters);
  for (float& r_i : result.radius) r_i = scaled.to_world(r_i);
  return result;
}

}  // namespace psf::filter
