#include "filter/average.h"

#include <chrono>
#include <memory>

#include "core/error.h"
#include "core/parallel.h"
#include "filter/problem.h"
#include "filter/values.h"

namespace psf::filter {
namespace {

constexpr std::size_t kGrain = 4096;

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void require_channels(const Records& records, const Parameters& parameters) {
  if (records.size() == 0) return;
  const auto has = [&records](std::string_view channel) {
    if (channel == "normal") return !records.normal.empty();
    if (channel == "reflectance") return !records.reflectance.empty();
    if (channel == "visibility") return !records.visibility.empty();
    if (channel == "hit_distance") return !records.hit_distance.empty();
    if (channel == "direction") return !records.direction.empty();
    return !records.material.empty();
  };
  for (const ChannelNeed& need : optional_channels(parameters)) {
    if (has(need.channel)) continue;
    throw Error(ErrorCode::bad_input, "the records have no channel " + std::string(need.channel) +
                                          ", which " + std::string(need.wanted_by) + " needs");
  }
}

std::vector<float> areas(const Records& records, const Roles& roles, const Block& block) {
  if (block.cameras.size() > 1) {
    throw Error(ErrorCode::usage,
                "--estimator disk counts a surface once for every camera that sees it: "
                "it needs a dump of one camera");
  }
  std::vector<float> area(records.size());
  for (const std::uint32_t j : roles.sources) {
    area[j] = static_cast<float>(surface_area(block.cameras[0].angle_per_pixel,
                                              double{records.distance[j]}, records.normal[j],
                                              records.direction[j], block.samples_per_pixel));
  }
  return area;
}

// c / rho of the sources.
std::vector<Rgb> demodulated(const Records& records, const Roles& roles) {
  std::vector<Rgb> values(records.size(), Rgb(0, 0, 0));
  for (const std::uint32_t j : roles.sources) {
    values[j] = demodulate(records.contribution[j], records.reflectance[j]);
  }
  return values;
}

// Back from the values averaged to radiance. Who averaged over itself alone keeps its own value,
// which dividing and multiplying would round.
void finish(const Records& records, const Roles& roles, std::span<const float> radius,
            const Parameters& parameters, Average& result) {
  const std::span<const std::uint32_t> queries = roles.queries;
  const auto finish_one = [&](std::uint32_t i) {
    const bool alone = result.neighbors[i] == 1 && roles.of[i] == Role::source;
    if (alone && (parameters.estimator == Estimator::average || radius[i] * radius[i] == 0)) {
      result.c_bar[i] = records.contribution[i];
    } else if (parameters.demodulate) {
      result.c_bar[i] = remodulate(result.c_bar[i], records.reflectance[i]);
    }
  };
  core::parallel_for(queries.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (const std::uint32_t i : queries.subspan(begin, end - begin)) finish_one(i);
  });
}

void leave_out_queries(Average& result) {
  for (Role& role : result.roles) {
    if (role == Role::query) role = Role::left_out;
  }
  result.statistics.without_source = result.statistics.queries;
}

}  // namespace

Average average(const Records& records, std::span<const float> radius, const Block& block,
                const Parameters& parameters) {
  require_channels(records, parameters);
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
  const Weights weights(records, parameters.weights);
  const Problem problem{records, roles, radius, weights, area};
  const std::unique_ptr<Engine> engine = make_engine(parameters.search, problem);
  result.statistics.seconds_index = seconds_since(start);

  const auto filter_start = Clock::now();
  std::vector<Rgb> previous;
  if (parameters.demodulate) previous = demodulated(records, roles);
  engine->average(parameters.demodulate ? previous : records.contribution,
                  parameters.count_refusals, result.c_bar, result.neighbors, result.statistics);
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

}  // namespace psf::filter
