// Times filter::estimate() on a sample, and finds the radius for a wanted number of neighbours.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/rows.h"
#include "bench/sample.h"
#include "filter/estimate.h"

namespace psf::bench {

// A radius r0, and the numbers of neighbours that it gives on a sample.
struct Reach {
  double r0 = 0;
  double neighbors = 0;  // mean number of sources averaged per record, with itself
  double in_ball = 0;    // the same without weights
  std::vector<float> radius;
};

struct Run {
  filter::Estimates average;
  double seconds = 0;  // time of the call of filter::estimate(): index, search, weights and sums
};

[[nodiscard]] Run run_filter(const Sample& sample, const Reach& reach, filter::EngineKind kind);

// The radius at which records have `neighbors` neighbours on average, within 2%; not set where no
// radius gives so many. `start`: r0 to try first, 0 where none is known.
[[nodiscard]] std::optional<Reach> find_reach(const Sample& sample, double neighbors,
                                              double start = 0);

// One measured time of the filter.
struct Point {
  std::string series;  // "speed", or the quantity that grows: "neighbors", "records"
  std::string search;  // "flann", "plain"
  std::size_t records = 0;
  Reach reach;  // without the radii
  std::size_t runs = 0;
  Spread seconds;
};

[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<Point>& points);

// The time of a point per record, and per neighbour of a record, in nanoseconds.
[[nodiscard]] double ns_per_record(const Point& point);
[[nodiscard]] double ns_per_neighbor(const Point& point);

}  // namespace psf::bench
