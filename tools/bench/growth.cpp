#include "bench/growth.h"

#include <fmt/format.h>

#include <cmath>

#include "bench/turns.h"
#include "core/parallel.h"

namespace psf::bench {
namespace {

std::string exponent(const Point& before, const Point& point) {
  if (before.series != point.series) return "";
  const auto size = [](const Point& p) {
    return p.series == "records" ? static_cast<double>(p.records) : p.reach.neighbors;
  };
  return fmt::format("{:.2f}", std::log(point.seconds.median / before.seconds.median) /
                                   std::log(size(point) / size(before)));
}

}  // namespace

std::optional<Point> growth_point(const Sample& sample, const char* series, std::size_t neighbors,
                                  double start, std::size_t repeat) {
  std::optional<Reach> reach = find_reach(sample, static_cast<double>(neighbors), start);
  if (!reach) return std::nullopt;
  const core::ThreadLimit one(1);
  std::vector<double> seconds;
  for (double total = 0; seconds.size() < repeat && total < kEnoughSeconds;) {
    seconds.push_back(run_filter(sample, *reach, filter::EngineKind::flann).seconds);
    total += seconds.back();
  }
  reach->radius = {};
  return Point{series, "flann", sample.size(), *reach, seconds.size(), spread(seconds)};
}

void print_growth(const std::vector<Point>& points) {
  constexpr const char* kRow =
      "{:<9}  {:>10}  {:>10}  {:>11}  {:>9}  {:>21}  {:>12}  {:>15}  {:>8}\n";
  fmt::print(kRow, "growth", "records", "neighbours", "in the ball", "seconds", "min..max",
             "ns a record", "ns a neighbour", "exponent");
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Point& point = points[k];
    fmt::print(
        kRow, point.series, point.records, fmt::format("{:.1f}", point.reach.neighbors),
        fmt::format("{:.1f}", point.reach.in_ball), fmt::format("{:.4g}", point.seconds.median),
        fmt::format("{:.4g} .. {:.4g}", point.seconds.min, point.seconds.max),
        fmt::format("{:.1f}", ns_per_record(point)), fmt::format("{:.3f}", ns_per_neighbor(point)),
        k == 0 ? "" : exponent(points[k - 1], point));
  }
}

}  // namespace psf::bench
