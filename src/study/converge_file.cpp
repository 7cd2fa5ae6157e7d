#include "study/converge_file.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

namespace psf::study {
namespace {

constexpr metrics::Metric kError = metrics::Metric::rel_mse;

std::string id_of(std::size_t series) {
  return series == 0 ? "unfiltered" : fmt::format("{:04}", series);
}

Json interval(const Interval& interval) {
  if (!std::isfinite(interval.low)) return nullptr;
  return {interval.low, interval.high};
}

// To the next point; null at the last.
Json slopes(const ConvergeSeries& series, std::size_t place) {
  const auto slope = [&](const auto& value) {
    if (place + 1 == series.points.size()) return Json(nullptr);
    const ConvergePoint &a = series.points[place], &b = series.points[place + 1];
    return number_or_null(
        local_slope(static_cast<double>(a.n), value(a), static_cast<double>(b.n), value(b)));
  };
  using Point = const ConvergePoint&;
  Json json = {{"relMSE", slope([](Point p) { return p.metrics[kError]; })},
               {"bias_sq", slope([](Point p) { return p.parts.bias_sq; })},
               {"variance", slope([](Point p) { return p.parts.variance; })}};
  json["theory_bias_sq_smooth"] = slope([](Point p) { return p.theory.bias_sq_smooth; });
  json["theory_bias_sq_edge"] = slope([](Point p) { return p.theory.bias_sq_edge; });
  json["theory_variance"] = slope([](Point p) { return p.theory.variance; });
  return json;
}

Json seconds(const ConvergeReport& report, const ConvergePoint& point, bool filtered) {
  Json json = {{"render", nullptr}, {"dump", nullptr}, {"filter", nullptr}};
  const auto n = static_cast<double>(point.n);
  if (report.time) {
    json["render"] = n * report.time->render;
    json["dump"] = filtered ? n * report.time->dump : 0.0;
  }
  if (!filtered) json["filter"] = 0.0;
  if (point.filter_seconds) json["filter"] = *point.filter_seconds;
  return json;
}

Json to_json(const ConvergeReport& report, std::size_t series, std::size_t place) {
  const ConvergePoint& point = report.series[series].points[place];
  const bool filtered = series > 0;
  return {{"n", point.n},
          {"metrics", study::to_json(point.metrics, report.measured)},
          {"neighbors", filtered ? Json(point.neighbors) : Json(nullptr)},
          {"radius_px", filtered ? number_or_null(point.radius) : Json(nullptr)},
          {"mse", number_or_null(point.parts.error)},
          {"bias_sq", number_or_null(point.parts.bias_sq)},
          {"bias_sq_ci", interval(point.parts.bias_sq_interval)},
          {"variance", number_or_null(point.parts.variance)},
          {"variance_ci", interval(point.parts.variance_interval)},
          {"slope", slopes(report.series[series], place)},
          {"seconds", seconds(report, point, filtered)},
          {"picture", report.with_pictures ? Json(picture_name(series, point.n)) : Json(nullptr)}};
}

// The unfiltered error after so many passes: between two points as a power of n, beyond them as
// 1 / n.
double unfiltered_error(const ConvergeSeries& unfiltered, double n) {
  const std::vector<ConvergePoint>& points = unfiltered.points;
  const auto at = [&](std::size_t k) { return static_cast<double>(points[k].n); };
  if (n <= at(0)) return points[0].metrics[kError] * at(0) / n;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    if (n > at(k + 1)) continue;
    const double slope =
        local_slope(at(k), points[k].metrics[kError], at(k + 1), points[k + 1].metrics[kError]);
    return points[k].metrics[kError] * std::pow(n / at(k), slope);
  }
  return points.back().metrics[kError] * at(points.size() - 1) / n;
}

// The number of passes with this unfiltered error, which falls as n grows.
double unfiltered_passes(const ConvergeSeries& unfiltered, double error) {
  double low = 1e-6, high = 1e15;
  for (int k = 0; k < 200; ++k) {
    const double middle = std::sqrt(low * high);
    (unfiltered_error(unfiltered, middle) > error ? low : high) = middle;
  }
  return high;
}

}  // namespace

std::string picture_name(std::size_t series, std::uint64_t n) {
  return fmt::format("{}.n{:04}.exr", id_of(series), n);
}

std::vector<SpeedUp> speed_ups(std::span<const ConvergeSeries> series, const RenderTime& time) {
  std::vector<SpeedUp> list;
  for (std::size_t k = 1; k < series.size(); ++k) {
    for (const ConvergePoint& point : series[k].points) {
      if (!point.filter_seconds) continue;
      const auto n = static_cast<double>(point.n);
      const double seconds = n * (time.render + time.dump) + *point.filter_seconds;
      const double error = point.metrics[kError];
      list.push_back({k, point.n, unfiltered_error(series[0], seconds / time.render) / error,
                      unfiltered_passes(series[0], error) * time.render / seconds});
    }
  }
  return list;
}

Json to_json(const ConvergeReport& report) {
  Json n = Json::array(), series = Json::array(), gains = Json::array();
  for (const ConvergePoint& point : report.series[0].points) n.push_back(point.n);
  for (std::size_t k = 0; k < report.series.size(); ++k) {
    const ConvergeSeries& one = report.series[k];
    Json points = Json::array();
    for (std::size_t t = 0; t < one.points.size(); ++t) points.push_back(to_json(report, k, t));
    series.push_back(
        {{"id", id_of(k)},
         {"parameters", one.parameters ? study::to_json(*one.parameters) : Json(nullptr)},
         {"points", points}});
  }
  for (const SpeedUp& gain : report.speed_ups) {
    gains.push_back({{"id", id_of(gain.series)},
                     {"n", gain.n},
                     {"equal_time", number_or_null(gain.equal_time)},
                     {"equal_error", number_or_null(gain.equal_error)}});
  }
  Json analytic = nullptr;
  if (!report.checks.empty()) {
    Json checks = Json::array();
    bool passed = true;
    for (const SlopeCheck& check : report.checks) {
      passed = passed && check.passed;
      checks.push_back({{"id", id_of(check.series)},
                        {"quantity", check.quantity},
                        {"measured", number_or_null(check.measured)},
                        {"theory", check.theory},
                        {"passed", check.passed}});
    }
    analytic = {{"passed", passed}, {"slopes", checks}};
  }
  return {{"kind", "converge"},
          {"format", kStudyFormat},
          {"version", report.version},
          {"inputs", report.inputs},
          {"reference", report.reference},
          {"metrics", report.metrics},
          {"n", n},
          {"series", series},
          {"speedups", gains},
          {"analytic", analytic}};
}

Json to_rows(const ConvergeReport& report) {
  Json rows = Json::array();
  const Json json = to_json(report);
  const Json& all = json["series"];
  const Json names = all.size() > 1 ? all[1]["parameters"] : Json::object();
  for (const Json& series : all) {
    for (const Json& point : series["points"]) {
      Json row = {{"id", series["id"]}};
      for (const auto& [name, value] : names.items()) {
        row[name] = series["parameters"].is_null() ? Json(nullptr) : series["parameters"][name];
      }
      for (const auto& [name, value] : point.items()) {
        if (value.is_object()) {
          for (const auto& [part, number] : value.items()) {
            row[name == "metrics" ? part : name + "_" + part] = number;
          }
        } else if (name.ends_with("_ci")) {
          row[name + "_low"] = value.is_null() ? value : value[0];
          row[name + "_high"] = value.is_null() ? value : value[1];
        } else {
          row[name] = value;
        }
      }
      rows.push_back(row);
    }
  }
  return rows;
}

std::string to_csv(const ConvergeReport& report) {
  return csv_table(to_rows(report));
}

ConvergePaths::ConvergePaths(const std::string& folder)
    : json((std::filesystem::path(folder) / "converge.json").string()),
      csv((std::filesystem::path(folder) / "converge.csv").string()) {}

}  // namespace psf::study
