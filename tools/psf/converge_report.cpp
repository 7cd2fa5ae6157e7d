#include "converge_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "filter/parameters/text.h"

namespace psf::tools {
namespace {

constexpr metrics::Metric kError = metrics::Metric::rel_mse;

// "1.2e-3", or "-" where there is none.
std::string number(double value, const char* format = "{:.3g}") {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

// What the sets differ in; everything of one set alone that is not the default.
std::string title(const study::ConvergeReport& report, std::size_t series) {
  if (series == 0) return "unfiltered, in theory n^-1";
  const filter::Parameters& parameters = *report.series[series].parameters;
  const auto own = filter::describe(parameters);
  std::vector<std::string> words;
  for (std::size_t k = 0; k < own.size(); ++k) {
    bool differs = own[k].first == "r0" || own[k].first == "delta";
    for (std::size_t other = 1; other < report.series.size(); ++other) {
      differs = differs || filter::describe(*report.series[other].parameters)[k] != own[k];
    }
    if (!differs) continue;
    const bool is_delta = own[k].first == "delta";
    words.push_back(own[k].first + " " +
                    (is_delta ? number(parameters.radius.delta) : own[k].second));
  }
  return fmt::format("{:04} {}", series, fmt::join(words, ", "));
}

std::string with_interval(double value, const study::Interval& interval) {
  if (!std::isfinite(interval.low)) return number(value);
  return fmt::format("{} [{}, {}]", number(value), number(interval.low), number(interval.high));
}

const study::SpeedUp* find(const study::ConvergeReport& report, std::size_t series,
                           std::uint64_t n) {
  const auto found = std::find_if(
      report.speed_ups.begin(), report.speed_ups.end(),
      [&](const study::SpeedUp& gain) { return gain.series == series && gain.n == n; });
  return found == report.speed_ups.end() ? nullptr : &*found;
}

void print_series(const study::ConvergeReport& report, std::size_t series) {
  const bool replicates = report.inputs.size() > 1;
  const bool filtered = series > 0;
  fmt::print("{}\n{:>6} {:>9} {:>6}", title(report, series), "n", metrics::name(kError), "slope");
  if (replicates) {
    fmt::print(" {:>30} {:>6} {:>13} {:>30} {:>6} {:>6}", "bias^2 [95%]", "slope", "smooth, edge",
               "variance [95%]", "slope", "theory");
  }
  if (filtered) fmt::print(" {:>8} {:>7} {:>8}", "M", "px", "filter s");
  if (filtered && !report.speed_ups.empty()) {
    fmt::print(" {:>10} {:>11}", "equal time", "equal error");
  }
  fmt::print("\n");
  const std::vector<study::ConvergePoint>& points = report.series[series].points;
  using Point = const study::ConvergePoint&;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const study::ConvergePoint& point = points[k];
    // To the next line, as in the files.
    const auto slope = [&](const auto& value) {
      if (k + 1 == points.size()) return std::string("-");
      return number(study::local_slope(static_cast<double>(point.n), value(point),
                                       static_cast<double>(points[k + 1].n), value(points[k + 1])),
                    "{:.2f}");
    };
    fmt::print("{:>6} {:>9} {:>6}", point.n, number(point.metrics[kError]),
               slope([](Point p) { return p.metrics[kError]; }));
    if (replicates) {
      const study::ErrorParts& parts = point.parts;
      const std::string smooth = slope([](Point p) { return p.theory.bias_sq_smooth; });
      const std::string edge = slope([](Point p) { return p.theory.bias_sq_edge; });
      fmt::print(" {:>30} {:>6} {:>13} {:>30} {:>6} {:>6}",
                 with_interval(parts.bias_sq, parts.bias_sq_interval),
                 slope([](Point p) { return p.parts.bias_sq; }),
                 filtered ? smooth + ", " + edge : "-",
                 with_interval(parts.variance, parts.variance_interval),
                 slope([](Point p) { return p.parts.variance; }),
                 filtered ? slope([](Point p) { return p.theory.variance; }) : "-1");
    }
    if (filtered) {
      fmt::print(" {:>8} {:>7} {:>8}", number(point.neighbors, "{:.1f}"),
                 number(point.radius, "{:.2f}"),
                 point.filter_seconds ? number(*point.filter_seconds, "{:.3f}") : "-");
      if (const study::SpeedUp* gain = find(report, series, point.n)) {
        fmt::print(" {:>10} {:>11}", number(gain->equal_time), number(gain->equal_error));
      }
    }
    fmt::print("\n");
  }
  fmt::print("\n");
}

// What one looks for: a line a set, after all passes.
void print_summary(const study::ConvergeReport& report) {
  fmt::print("after {} passes\n{:>9} {:>10} {:>10} {:>8} {:>10} {:>11}\n",
             report.series[0].points.back().n, metrics::name(kError), "bias^2", "variance", "M",
             "equal time", "equal error");
  for (std::size_t series = 0; series < report.series.size(); ++series) {
    const study::ConvergePoint& point = report.series[series].points.back();
    const study::SpeedUp* gain = find(report, series, point.n);
    fmt::print("{:>9} {:>10} {:>10} {:>8} {:>10} {:>11}  {}\n", number(point.metrics[kError]),
               number(point.parts.bias_sq), number(point.parts.variance),
               series > 0 ? number(point.neighbors, "{:.1f}") : "-",
               gain != nullptr ? number(gain->equal_time) : "-",
               gain != nullptr ? number(gain->equal_error) : "-", title(report, series));
  }
}

}  // namespace

void print_convergence(const study::ConvergeReport& report) {
  for (std::size_t k = 0; k < report.series.size(); ++k) print_series(report, k);
  print_summary(report);
  if (report.inputs.size() > 1) {
    const study::ErrorParts& parts = report.series[0].points.back().parts;
    fmt::print(
        "bias^2 of the unfiltered picture, {} at the end, is the reference's own error and in "
        "every "
        "bias^2\n",
        with_interval(parts.bias_sq, parts.bias_sq_interval));
  } else {
    fmt::print("one replicate: bias and variance are not told apart; give dumps of other seeds\n");
  }
  if (!report.time) {
    fmt::print("no speed-ups: give psf-render's figures with --render-json\n");
  }
}

void print_checks(const study::ConvergeReport& report) {
  fmt::print("{:>8} {:>9} {:>10} {:>9} {:>9}\n", "delta", "", "measured", "theory", "");
  for (const study::SlopeCheck& check : report.checks) {
    fmt::print("{:>8} {:>9} {:>10.3f} {:>9.3f} {:>9}\n",
               number(report.series[check.series].parameters->radius.delta), check.quantity,
               check.measured, check.theory, check.passed ? "passed" : "FAILED");
  }
}

}  // namespace psf::tools
