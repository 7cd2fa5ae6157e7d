#include "study/theory.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "filter/blocks.h"
#include "filter/radius.h"
#include "run/passes.h"

namespace psf::study {

double share_right(double s) {
  if (s >= 1) return 1;
  if (s <= -1) return 0;
  return 0.5 + (s * std::sqrt(1 - s * s) + std::asin(s)) / std::numbers::pi;
}

Theory theory(const run::Dump& dump, const filter::Parameters& parameters, std::uint64_t n) {
  const filter::Blocks blocks(parameters.block, dump.pass_bounds(), 0, n);
  struct Part {
    double share, r;  // a block's share of the paths, and its radius
  };
  std::vector<Part> parts;
  double largest = 0, bias = 0, variance = 0;
  for (std::uint64_t k = 0; k < blocks.count(); ++k) {
    const double share =
        static_cast<double>(blocks[k].size()) / static_cast<double>(blocks.all().size());
    const double r = filter::radius_scale(
        parameters.radius, describe_block(dump, blocks, k, parameters.radius.count).n);
    parts.push_back({share, r});
    largest = std::max(largest, r);
    // The mean over a disk is off by r^2 / 8 times the Laplacian; its variance is that of a record
    // over the number of records, which is as the block's size and r^2.
    bias += share * r * r;
    variance += share * share / (static_cast<double>(blocks[k].size()) * r * r);
  }
  // Beside a step of 1, at a distance of d, the mean of the blocks is off by their mean share of
  // disk beyond it.
  constexpr int kSteps = 256;
  double edge = 0;
  for (int step = 0; step < kSteps; ++step) {
    const double d = (step + 0.5) / kSteps * largest;
    double off = 0;
    for (const Part& part : parts) off += part.r > 0 ? part.share * share_right(-d / part.r) : 0;
    edge += off * off * largest / kSteps;
  }
  return {bias * bias, edge, variance};
}

}  // namespace psf::study
