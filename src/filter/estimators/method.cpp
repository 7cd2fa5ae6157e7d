#include "filter/estimators/method.h"

#include <utility>

#include "core/parallel.h"
#include "core/seconds.h"
#include "filter/inputs.h"

namespace psf::filter {
namespace {

constexpr std::size_t kQueriesARange = 4096;

using core::Clock;
using core::seconds_since;

// Applies finished() to the average of every query.
void finish(const MethodInput& input, const Roles& roles, std::span<const float> radius,
            Estimates& result) {
  const std::span<const std::uint32_t> queries = roles.queries;
  core::parallel_for(queries.size(), kQueriesARange, [&](std::size_t begin, std::size_t end) {
    for (const std::uint32_t i : queries.subspan(begin, end - begin)) {
      result.c_bar[i] = finished(result.c_bar[i], result.neighbors[i], roles.of[i] == Role::source,
                                 radius[i], input.records, i, input.parameters);
    }
  });
}

}  // namespace

Estimates apply_engine(const MethodInput& input, const EngineSteps& steps) {
  const auto& [records, given, block, parameters] = input;
  Estimates result;
  const auto start = Clock::now();
  Roles roles = find_roles(records, block, parameters, result.statistics);
  result.c_bar.assign(records.size(), Rgb(0, 0, 0));
  result.neighbors.assign(records.size(), 0);
  if (roles.sources.empty()) {
    result.roles = std::move(roles.of);
    leave_out_queries(result.roles, result.statistics);
    return result;
  }
  std::vector<float> area;
  if (steps.areas != nullptr) area = steps.areas(records, roles, block);
  const Weights weights(records, terms_in_use(records, parameters.weights));
  std::vector<Rgb> previous;
  if (parameters.demodulate) previous = demodulated(records, roles);
  const std::span<const Rgb> values = parameters.demodulate ? previous : records.contribution;
  std::span<const float> radius = given;
  if (steps.radii != nullptr) {
    result.radius = steps.radii({records, roles, given, weights, area}, values, parameters);
    radius = result.radius;
  }
  const Problem problem{records, roles, radius, weights, area};
  const std::unique_ptr<Engine> engine = steps.engine(problem, block, parameters);
  result.statistics.seconds_index = seconds_since(start);

  const auto filter_start = Clock::now();
  engine->apply(values, parameters.count_refusals, result.c_bar, result.neighbors,
                result.statistics);
  for (std::uint32_t k = 1; k < parameters.iterations; ++k) {
    std::swap(previous, result.c_bar);
    result.c_bar.resize(records.size(), Rgb(0, 0, 0));
    Statistics repeated;  // the same neighbours: counted once
    engine->apply(previous, false, result.c_bar, result.neighbors, repeated);
  }
  finish(input, roles, radius, result);
  result.roles = std::move(roles.of);
  result.statistics.seconds_filter = seconds_since(filter_start);
  return result;
}

std::unique_ptr<Engine> ball_engine(const Problem& problem, const Block&,
                                    const Parameters& parameters) {
  return make_engine(parameters.engine, problem);
}

void leave_out_queries(std::span<Role> roles, Statistics& statistics) {
  for (Role& role : roles) {
    if (role == Role::query) role = Role::left_out;
  }
  statistics.without_source = statistics.queries;
}

}  // namespace psf::filter
