#include "bench/filter_run.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/radius.h"

namespace psf::bench {
namespace {

filter::Block block_of(const Sample& sample) {
  return {0, 1, 1, sample.cameras};
}

void set_radius(const Sample& sample, double r0, Reach& reach) {
  filter::Radius radius = sample.parameters.radius;
  radius.r0 = reach.r0 = r0;
  filter::radii(radius, sample.records.view(), block_of(sample), reach.radius);
}

double mean_neighbors(const Sample& sample, const Reach& reach,
                      const filter::WeightTerms& weights) {
  filter::Parameters parameters = sample.parameters;
  parameters.weights = weights;
  return filter::estimate(sample.records.view(), reach.radius, block_of(sample), parameters)
      .statistics.mean_neighbors();
}

// A few pixels; where the camera does not say how large they are, of a picture of one radian.
double first_r0(const Sample& sample) {
  constexpr double kPixels = 2;
  const bool pixels = sample.parameters.radius.basis == filter::RadiusBasis::footprint;
  return pixels ? kPixels : kPixels / sample.cameras[0].width;
}

}  // namespace

Run run_filter(const Sample& sample, const Reach& reach, filter::EngineKind kind) {
  filter::Parameters parameters = sample.parameters;
  parameters.engine = kind;
  Run run;
  run.seconds = seconds_of([&] {
    run.average =
        filter::estimate(sample.records.view(), reach.radius, block_of(sample), parameters);
  });
  return run;
}

std::optional<Reach> find_reach(const Sample& sample, double neighbors, double start) {
  constexpr int kMostSteps = 20;
  constexpr double kTolerance = 0.02;
  constexpr double kSaturated = 0.1;  // least slope of log neighbours over log r0; a surface has 2
  if (neighbors > static_cast<double>(sample.size())) return std::nullopt;
  Reach reach;
  double low = 0, high = std::numeric_limits<double>::infinity(), at_low = 0;
  double r0 = start > 0 ? start : first_r0(sample);
  for (int k = 0; k < kMostSteps; ++k) {
    set_radius(sample, r0, reach);
    reach.neighbors = mean_neighbors(sample, reach, sample.parameters.weights);
    if (std::abs(reach.neighbors / neighbors - 1) <= kTolerance) {
      reach.in_ball = mean_neighbors(sample, reach, filter::WeightTerms::none());
      return reach;
    }
    if (reach.neighbors > neighbors) {
      high = r0;
    } else {
      const bool grows = std::log(reach.neighbors / at_low) > kSaturated * std::log(r0 / low);
      if (at_low > 2 && high > std::numeric_limits<double>::max() && !grows) return std::nullopt;
      low = r0;
      at_low = reach.neighbors;
    }
    // The surface in the ball grows like the square of the radius. The record itself does not.
    const double others = std::max(reach.neighbors - 1, 1e-3);
    r0 *= std::clamp(std::sqrt((neighbors - 1) / others), 0.25, 4.0);
    if (r0 <= low || r0 >= high) r0 = std::sqrt(low * high);
  }
  return std::nullopt;
}

nlohmann::ordered_json to_json(const std::vector<Point>& points) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const Point& point : points) {
    out.push_back({{"series", point.series},
                   {"search", point.search},
                   {"records", point.records},
                   {"r0", point.reach.r0},
                   {"neighbors", point.reach.neighbors},
                   {"in_ball", point.reach.in_ball},
                   {"runs", point.runs},
                   {"seconds",
                    {{"median", point.seconds.median},
                     {"min", point.seconds.min},
                     {"max", point.seconds.max}}},
                   {"ns_per_record", ns_per_record(point)},
                   {"ns_per_neighbor", ns_per_neighbor(point)}});
  }
  return out;
}

double ns_per_record(const Point& point) {
  return 1e9 * point.seconds.median / static_cast<double>(point.records);
}

double ns_per_neighbor(const Point& point) {
  return ns_per_record(point) / point.reach.neighbors;
}

}  // namespace psf::bench
