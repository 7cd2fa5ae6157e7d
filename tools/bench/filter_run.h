// filter::average() on a sample, timed, and the radius that gives a wanted number of neighbours.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/rows.h"
#include "bench/sample.h"
#include "filter/average.h"

namespace psf::bench {

// A radius r0, and what it gives on a sample.
struct Reach {
  double r0 = 0;
  double neighbors = 0;  // averaged a record, itself included
  double in_ball = 0;    // the same without weights
  std::vector<float> radius;
};

struct Run {
  filter::Average average;
  double seconds = 0;  // of the whole call of filter::average(): index, search, weights and sums
};

[[nodiscard]] Run run_filter(const Sample& sample, const Reach& reach, search::Kind kind);

// The radius at which a record has `neighbors` of them in the mean, within 2%. `start`: r0 to try
// first, 0 where none is known. Nothing where no radius gives so many.
[[nodiscard]] std::optional<Reach> find_reach(const Sample& sample, double neighbors,
                                              double start = 0);

// One measured time of the filter.
struct Point {
  std::string series;  // "speed", or what grows: "neighbors", "records"
  std::string search;  // "flann", "plain"
  std::size_t records = 0;
  Reach reach;  // without the radii
  std::size_t runs = 0;
  Spread seconds;
};

[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<Point>& points);

// What a point's time is for each of its records, and for each neighbour of each.
[[nodiscard]] double ns_per_record(const Point& point);
[[nodiscard]] double ns_per_neighbor(const Point& point);

}  // namespace psf::bench
