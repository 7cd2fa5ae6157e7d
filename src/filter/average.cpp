#include "filter/average.h"

#include <chrono>
#include <memory>

#include "core/error.h"
#include "filter/plain.h"
#include "filter/values.h"
#include "search/curve_order.h"

namespace psf::filter {
namespace {

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

std::unique_ptr<search::Search> index_of(const Records& records, const Roles& roles,
                                         search::Kind kind) {
  std::vector<Vec3> positions;
  positions.reserve(roles.sources.size());
  for (const std::uint32_t j : roles.sources) positions.push_back(records.position[j]);
  return search::make_search(kind, positions);
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

// Back from the values averaged to radiance.
void finish(const Records& records, const Roles& roles, std::span<const float> radius,
            const Parameters& parameters, Average& result) {
  for (const std::uint32_t i : roles.queries) {
    // Who averaged over itself alone keeps its own value, which dividing and multiplying would
    // round.
    const bool alone = result.neighbors[i] == 1 && roles.of[i] == Role::source;
    if (alone && (parameters.estimator == Estimator::average || radius[i] * radius[i] == 0)) {
      result.c_bar[i] = records.contribution[i];
    } else if (parameters.demodulate) {
      result.c_bar[i] = remodulate(result.c_bar[i], records.reflectance[i]);
    }
  }
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
  const std::unique_ptr<search::Search> search = index_of(records, roles, parameters.search);
  const std::vector<std::uint32_t> order = search::curve_order(records.position, roles.queries);
  const bool disk = parameters.estimator == Estimator::disk;
  const std::vector<float> area = disk ? areas(records, roles, block) : std::vector<float>();
  const Weights weights(records, parameters.weights);
  result.statistics.seconds_index = seconds_since(start);

  const auto filter_start = Clock::now();
  Problem problem{records, roles, radius, order, *search, weights, area, parameters.count_refusals};
  std::vector<Rgb> previous;
  if (parameters.demodulate) previous = demodulated(records, roles);
  std::span<const Rgb> values = parameters.demodulate ? previous : records.contribution;
  plain_average(problem, values, result.c_bar, result.neighbors, result.statistics);
  problem.count_refusals = false;
  for (std::uint32_t k = 1; k < parameters.iterations; ++k) {
    std::swap(previous, result.c_bar);
    result.c_bar.resize(records.size(), Rgb(0, 0, 0));
    Statistics repeated;  // the same neighbours: counted once
    plain_average(problem, previous, result.c_bar, result.neighbors, repeated);
  }
  finish(records, roles, radius, parameters, result);
  result.roles = std::move(roles.of);
  result.statistics.seconds_filter = seconds_since(filter_start);
  return result;
}

}  // namespace psf::filter
