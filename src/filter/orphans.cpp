#include "filter/orphans.h"

#include "filter/sum.h"

namespace psf::filter {
namespace {

constexpr std::size_t kFirstReach = 16, kGrowth = 8;

}  // namespace

Adopted adopt(const search::Search& search, const Problem& problem, std::uint32_t i) {
  Adopted adopted;
  std::vector<search::Neighbor> nearest;
  for (std::size_t reach = kFirstReach;; reach *= kGrowth) {
    search.nearest(problem.records.position[i], reach, nearest);
    adopted.sources.clear();
    for (const search::Neighbor& candidate : nearest) {
      const std::uint32_t j = problem.roles.sources[candidate.index];
      if (problem.weights.pass(i, j, problem.radius[i])) adopted.sources.push_back(j);
      if (adopted.sources.size() == kOrphanSources) return adopted;
    }
    if (reach >= search.size()) break;
  }
  if (adopted.sources.empty()) {
    adopted.sources.push_back(problem.roles.sources[nearest.front().index]);
    adopted.matched = false;
  }
  return adopted;
}

Rgb mean_of(const Adopted& adopted, std::span<const Rgb> values) {
  Sum sum;
  for (const std::uint32_t j : adopted.sources) sum.add(values[j], 1);
  return sum.over(static_cast<double>(adopted.sources.size()));
}

void average_adopted(const Adopted& adopted, std::uint32_t i, std::span<const Averaged> all,
                     Statistics& statistics) {
  statistics.add_orphan(adopted.matched);
  for (const auto& [values, out] : all) out[i] = mean_of(adopted, values);
}

}  // namespace psf::filter
