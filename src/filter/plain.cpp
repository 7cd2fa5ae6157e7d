#include "filter/plain.h"

#include <algorithm>
#include <numbers>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "filter/orphans.h"

namespace psf::filter {
namespace {

constexpr std::size_t kGrain = 256;  // queries a range

// Of float values, in double.
struct Sum {
  double x = 0, y = 0, z = 0;
  void add(const Rgb& v, double weight) {
    x += weight * double{v.x};
    y += weight * double{v.y};
    z += weight * double{v.z};
  }
  [[nodiscard]] Rgb over(double divisor) const {
    return {static_cast<float>(x / divisor), static_cast<float>(y / divisor),
            static_cast<float>(z / divisor)};
  }
};

// Works on queries one after the other; one a range, so nothing is shared.
class Worker {
 public:
  Worker(const Problem& problem, std::span<const Rgb> values) : p_(problem), values_(values) {}

  // Returns how many neighbours there were.
  std::uint32_t average(std::uint32_t i, Rgb& out) {
    const float r_i = p_.radius[i], r_sq = r_i * r_i;
    const bool own = p_.roles.of[i] == Role::source;
    const bool disk = !p_.area.empty();
    Sum sum;
    std::uint32_t count = 0;
    if (own) {
      sum.add(values_[i], disk ? double{p_.area[i]} : 1);
      ++count;
    }
    if (r_sq > 0) {
      p_.search.within(p_.records.position[i], r_sq, found_);
      for (const search::Neighbor& neighbor : found_) {
        const std::uint32_t j = p_.roles.sources[neighbor.index];
        if (j == i) continue;
        ++counts.candidates;
        if (!passes(i, j, r_i)) continue;
        sum.add(values_[j], disk ? double{p_.area[j]} : 1);
        ++count;
      }
    }
    counts.candidates += own ? 1 : 0;
    counts.accepted += count;
    counts.min_neighbors = std::min(counts.min_neighbors, std::uint64_t{count});
    counts.max_neighbors = std::max(counts.max_neighbors, std::uint64_t{count});
    if (count == 0) {
      out = adopted(i, r_i);
    } else if (disk && r_sq > 0) {
      out = sum.over(std::numbers::pi * double{r_i} * double{r_i});
    } else if (disk) {
      out = values_[i];  // a disk without area: the record itself
    } else {
      out = sum.over(count);
    }
    return count;
  }

  Statistics counts;

 private:
  [[nodiscard]] bool passes(std::uint32_t i, std::uint32_t j, float r_i) {
    if (!p_.count_refusals) return p_.weights.pass(i, j, r_i);
    const std::uint32_t refusers = p_.weights.refusers(i, j, r_i);
    for (std::size_t k = 0; k < kTermCount; ++k) counts.refused[k] += (refusers >> k) & 1;
    return refusers == 0;
  }

  // An orphan's average, without areas: it is not a density any more.
  [[nodiscard]] Rgb adopted(std::uint32_t i, float r_i) {
    ++counts.orphans;
    if (!adopt(p_.search, p_.records, p_.roles.sources, p_.weights, i, r_i, found_, adopted_)) {
      ++counts.orphans_unmatched;
    }
    Sum sum;
    for (const std::uint32_t j : adopted_) sum.add(values_[j], 1);
    return sum.over(static_cast<double>(adopted_.size()));
  }

  const Problem& p_;
  std::span<const Rgb> values_;
  std::vector<search::Neighbor> found_;
  std::vector<std::uint32_t> adopted_;
};

}  // namespace

void plain_average(const Problem& problem, std::span<const Rgb> values, std::span<Rgb> out,
                   std::span<std::uint32_t> neighbors, Statistics& statistics) {
  std::vector<Statistics> parts(core::range_count(problem.order.size(), kGrain));
  core::parallel_for(problem.order.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    core::throw_if_interrupted("no picture was written");
    Worker worker(problem, values);
    for (const std::uint32_t i : problem.order.subspan(begin, end - begin)) {
      neighbors[i] = worker.average(i, out[i]);
    }
    parts[begin / kGrain] = worker.counts;
  });
  for (const Statistics& part : parts) statistics += part;
}

}  // namespace psf::filter
