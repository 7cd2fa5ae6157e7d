#include "filter/orphans.h"

#include <algorithm>

namespace psf::filter {
namespace {

constexpr std::size_t kFirstReach = 16, kLastReach = 1024;

}  // namespace

bool adopt(const search::Search& search, const Records& records,
           const std::vector<std::uint32_t>& sources, const Weights& weights, std::uint32_t i,
           float r_i, std::vector<search::Neighbor>& scratch, std::vector<std::uint32_t>& out) {
  const Vec3 x_i = records.position[i];
  out.clear();
  std::uint32_t nearest = 0;
  for (std::size_t k = kFirstReach; k <= kLastReach; k *= 4) {
    search.nearest(x_i, k, scratch);
    nearest = sources[scratch.front().index];
    for (const search::Neighbor& candidate : scratch) {
      const std::uint32_t j = sources[candidate.index];
      if (weights.pass(i, j, r_i)) out.push_back(j);
      if (out.size() == kOrphanSources) break;
    }
    if (!out.empty()) return true;
    if (k >= sources.size()) break;
  }
  // All the others: one walk over the sources costs less than ever more nearest ones.
  scratch.clear();
  for (std::size_t s = 0; sources.size() > kLastReach && s < sources.size(); ++s) {
    const std::uint32_t j = sources[s];
    if (!weights.pass(i, j, r_i)) continue;
    scratch.push_back(
        {static_cast<std::uint32_t>(s), search::distance_sq(x_i, records.position[j])});
  }
  const auto closer = [](const search::Neighbor& a, const search::Neighbor& b) {
    return a.d_sq != b.d_sq ? a.d_sq < b.d_sq : a.index < b.index;
  };
  const std::size_t count = std::min(kOrphanSources, scratch.size());
  std::partial_sort(scratch.begin(), scratch.begin() + static_cast<std::ptrdiff_t>(count),
                    scratch.end(), closer);
  for (std::size_t s = 0; s < count; ++s) out.push_back(sources[scratch[s].index]);
  if (!out.empty()) return true;
  out.push_back(nearest);
  return false;
}

}  // namespace psf::filter
