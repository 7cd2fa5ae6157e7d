#include "bench/filter_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "bench/turns.h"
#include "core/parallel.h"

namespace psf::bench {
namespace {

std::optional<Target> speed_target(std::size_t neighbors) {
  constexpr std::pair<std::size_t, double> kTargets[] = {
      {35, 8}, {400, 20}, {3000, 60}, {10000, 100}};
  for (const auto& [count, ratio] : kTargets) {
    if (count == neighbors) return Target{Target::Kind::at_least, ratio};
  }
  return std::nullopt;
}

double relative_difference(float a, float b) {
  if (a == b) return 0;
  return std::abs(double{a} - double{b}) / std::max(std::abs(double{a}), std::abs(double{b}));
}

Row figure(std::string name, std::string what, double value, double most) {
  return {std::move(name),
          std::move(what),
          "",
          {value, value, value},
          Target{Target::Kind::at_most, most},
          ""};
}

}  // namespace

void Agreement::add(const filter::Estimates& a, const filter::Estimates& b) {
  for (std::size_t i = 0; i < a.c_bar.size(); ++i) {
    if (a.neighbors[i] != b.neighbors[i] || a.roles[i] != b.roles[i]) ++differing;
    for (int k = 0; k < 3; ++k) {
      const double difference = relative_difference(a.c_bar[i][k], b.c_bar[i][k]);
      if (!(difference <= c_bar)) c_bar = difference;  // NaN too
    }
  }
}

std::vector<Row> agreement_rows(const Agreement& agreement) {
  constexpr double kRounding = 1e-5;  // rounding error of sums in another order
  return {figure("neighbors_differ", "records with other neighbours than plain FLANN's",
                 static_cast<double>(agreement.differing), 0),
          figure("c_bar_differs", "largest relative difference of an average", agreement.c_bar,
                 kRounding)};
}

Row speed_row(const Sample& sample, const Reach& reach, std::size_t wanted, std::size_t repeat,
              Agreement& agreement, std::vector<Point>& points) {
  const core::ThreadLimit one(1);
  Run plain, flann;
  const Turns turns(
      repeat,
      [&] { return (plain = run_filter(sample, reach, filter::EngineKind::plain)).seconds; },
      [&] { return (flann = run_filter(sample, reach, filter::EngineKind::flann)).seconds; });
  agreement.add(plain.average, flann.average);
  const Reach known{reach.r0, reach.neighbors, reach.in_ball, {}};
  const std::size_t runs = turns.first.size();
  points.push_back({"speed", "plain", sample.size(), known, runs, spread(turns.first)});
  points.push_back({"speed", "flann", sample.size(), known, runs, spread(turns.second)});
  return {fmt::format("speed_{}", wanted),
          fmt::format("plain FLANN / filter, {} neighbours, 1 thread", wanted),
          "x",
          turns.ratio(),
          speed_target(wanted),
          fmt::format("{}; {:.1f} neighbours of {:.1f} in the ball, {:.3g} ns each", turns.detail(),
                      reach.neighbors, reach.in_ball, ns_per_neighbor(points.back()))};
}

Row threads_row(const Sample& sample, const Reach& reach, std::size_t threads, std::size_t repeat) {
  const auto with = [&](std::size_t count) {
    const core::ThreadLimit limit(count);
    return run_filter(sample, reach, filter::EngineKind::flann).seconds;
  };
  const Turns turns(
      repeat, [&] { return with(1); }, [&] { return with(threads); });
  std::optional<Target> target;
  if (threads == 2) target = Target{Target::Kind::at_least, 1.9};
  return {fmt::format("threads_{}", threads),
          fmt::format("1 thread / {}, {:.0f} neighbours", threads, reach.neighbors),
          "x",
          turns.ratio(),
          target,
          turns.detail()};
}

Row passes_row(const Sample& sample, const Reach& reach, std::size_t repeat) {
  const core::ThreadLimit one(1);
  const std::size_t half = (sample.passes.size() - 1) / 2;
  const filter::Records records = sample.records.view();
  const std::span<const float> radius = reach.radius;
  const auto filter_passes = [&](std::size_t count) {
    return seconds_of([&] {
      for (std::size_t p = 0; p < count; ++p) {
        const std::size_t first = sample.passes[p], last = sample.passes[p + 1];
        const filter::Block block{first, 1, 1, sample.cameras};
        static_cast<void>(filter::estimate(part(records, first, last),
                                           radius.subspan(first, last - first), block,
                                           sample.parameters));
      }
    });
  };
  const Turns turns(
      repeat, [&] { return filter_passes(2 * half); }, [&] { return filter_passes(half); });
  return {"passes_2x",
          fmt::format("{} passes / {}, a pass a block, 1 thread", 2 * half, half),
          "x",
          turns.ratio(),
          Target{Target::Kind::at_most, 2.1},
          turns.detail()};
}

}  // namespace psf::bench
