// Folders as psf sweep, converge and ablate write them, with values that are known in advance.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "film/image.h"

namespace psf::tests {

using Json = nlohmann::ordered_json;

constexpr std::size_t kSampleWidth = 40, kSampleHeight = 30;

// The reference: a ramp, with one bright pixel at (5, 3).
inline Rgb sample_radiance(std::size_t x, std::size_t y) {
  if (x == 5 && y == 3) return {8, 4, 2};
  return {0.125f + static_cast<float>(x) / 64, 0.125f + static_cast<float>(y) / 64, 0.25f};
}

// The reference times `scale`, and `offset` added in every other pixel.
inline film::Image sample_picture(float scale, float offset = 0) {
  film::Image image;
  image.width = kSampleWidth;
  image.height = kSampleHeight;
  std::vector<float> values;
  for (std::size_t y = 0; y < kSampleHeight; ++y) {
    for (std::size_t x = 0; x < kSampleWidth; ++x) {
      const Rgb color = sample_radiance(x, y);
      for (int k = 0; k < 3; ++k)
        values.push_back(scale * color[k] + ((x + y) % 2 == 0 ? offset : 0));
    }
  }
  image.add("", "RGB", values);
  return image;
}

inline Json sample_metrics(double error) {
  return {{"relMSE", error}, {"PSNR", 40 - 100 * error}, {"SSIM", 1 - error}, {"FLIP", nullptr}};
}

inline Json sample_head(const std::string& kind) {
  return {{"kind", kind},
          {"format", 1},
          {"version", "0.1.0"},
          {"reference", {{"file", "/somewhere/truth.exr"}, {"picture", "reference.exr"}}},
          {"metrics",
           {{{"name", "relMSE"}, {"settings", "epsilon 0.01"}, {"lower_is_better", true}},
            {{"name", "PSNR"}, {"lower_is_better", false}},
            {{"name", "SSIM"}, {"lower_is_better", false}},
            {{"name", "FLIP"}, {"lower_is_better", true}}}}};
}

inline Json sample_input(const std::string& scene, int seed) {
  return {{"file", "/somewhere/room.pvb"},
          {"uuid", "0123"},
          {"scene", scene},
          {"integrator", "path"},
          {"sampler", "sobol"},
          {"seed", seed},
          {"passes", 16},
          {"records", 1048576},
          {"width", kSampleWidth},
          {"height", kSampleHeight},
          {"camera", "main"}};
}

inline Json sample_parameters(const std::string& r0, const std::string& delta,
                              const std::string& block) {
  return {{"estimator", "average"}, {"r0", r0},         {"delta", delta},
          {"block", block},         {"normal", "0.95"}, {"visibility", "on"}};
}

// 12 rows: r0 4px, 8px, 16px; delta 0.2, 0.5; block 1pass, all. The error is 0.01 at row 0006 (r0
// 8px, delta 0.2, block all), more the farther r0 and delta are from it, 0.4 unfiltered.
inline Json sample_sweep(const std::string& scene) {
  Json sweep = sample_head("sweep");
  sweep["input"] = sample_input(scene, 1);
  sweep["unfiltered"] = {{"metrics", sample_metrics(0.4)}, {"picture", "unfiltered.exr"}};
  sweep["rows"] = Json::array();
  int number = 0;
  for (const char* r0 : {"4px", "8px", "16px"}) {
    for (const char* delta : {"0.2", "0.5"}) {
      for (const char* block : {"1pass", "all"}) {
        ++number;
        const std::string id = (number < 10 ? "000" : "00") + std::to_string(number);
        const double radius = std::stod(r0);
        const double error = 0.01 * (1 + 3 * std::abs(std::log2(radius / 8))) *
                             (std::string(delta) == "0.2" ? 1 : 1.5) *
                             (std::string(block) == "all" ? 1 : 2);
        sweep["rows"].push_back({{"id", id},
                                 {"parameters", sample_parameters(r0, delta, block)},
                                 {"metrics", sample_metrics(error)},
                                 {"neighbors", radius * radius},
                                 {"radius", {{"first_px", radius}, {"last_px", radius / 2}}},
                                 {"seconds", 0.31},
                                 {"shared", 6},
                                 {"picture", id + ".exr"}});
      }
    }
  }
  return sweep;
}

// Unfiltered and delta 0.2, 0.5 at n = 1, 2, 4, 8, by the theory where the radiance is smooth:
// bias^2 0.01 n^(-2 delta), variance 0.1 n^-(1 - delta), unfiltered 1/n.
inline Json sample_converge(const std::string& scene) {
  Json converge = sample_head("converge");
  converge["inputs"] = {sample_input(scene, 1), sample_input(scene, 2), sample_input(scene, 3)};
  const std::vector<int> counts = {1, 2, 4, 8};
  converge["n"] = counts;
  converge["series"] = Json::array();
  converge["speedups"] = Json::array();
  for (const std::string delta : {"", "0.2", "0.5"}) {
    const bool filtered = !delta.empty();
    const std::string id = !filtered ? "unfiltered" : delta == "0.2" ? "0001" : "0002";
    const double d = filtered ? std::stod(delta) : 0;
    Json points = Json::array();
    for (const int n : counts) {
      const double bias_sq = 0.01 * std::pow(n, -2 * d);
      const double variance = filtered ? 0.1 * std::pow(n, d - 1) : 1.0 / n;
      const bool last = n == counts.back();
      Json point = {
          {"n", n},
          {"metrics", sample_metrics(variance + (filtered ? bias_sq : 0))},
          {"neighbors", filtered ? Json(100 * std::pow(n, 1 - d)) : Json()},
          {"radius_px", filtered ? Json(8 * std::pow(n, -d / 2)) : Json()},
          {"mse", 0.5 * variance},
          {"bias_sq", filtered ? Json(bias_sq) : Json()},
          {"bias_sq_ci", filtered ? Json({-0.001, 1.5 * bias_sq}) : Json()},
          {"variance", variance},
          {"variance_ci", {0.8 * variance, 1.3 * variance}},
          {"slope",
           {{"relMSE", last ? Json() : Json(-0.9)},
            {"bias_sq", last || !filtered ? Json() : Json(-2 * d)},
            {"variance", last ? Json() : Json(filtered ? d - 1 : -1)}}},
          {"seconds",
           {{"render", 0.5 * n}, {"dump", 0.01 * n}, {"filter", 0.1 * n * (filtered ? 1 : 0)}}},
          {"picture", id + ".n000" + std::to_string(n) + ".exr"}};
      points.push_back(point);
      if (filtered) {
        converge["speedups"].push_back(
            {{"id", id}, {"n", n}, {"equal_time", 7.5}, {"equal_error", last ? Json() : Json(9)}});
      }
    }
    Json series = {{"id", id}, {"parameters", nullptr}, {"points", points}};
    if (filtered) series["parameters"] = sample_parameters("8px", delta, "all");
    converge["series"].push_back(series);
  }
  converge["analytic"] = {{"passed", true},
                          {"slopes",
                           {{{"id", "0002"},
                             {"quantity", "bias_sq"},
                             {"measured", -1.04},
                             {"theory", -1},
                             {"passed", true}}}}};
  return converge;
}

// Without filter 0.4, with weights 0.02 and 0.01; blocks 0.03 and 0.015; of one pass 4, iterations
// 0.1 and 0.05.
inline Json sample_ablate(const std::string& scene) {
  Json ablate = sample_head("ablate");
  ablate["input"] = sample_input(scene, 1);
  ablate["rows"] = Json::array();
  const auto add = [&](const char* part, const char* label, double error, int passes) {
    const bool filtered = std::string(label) != "unfiltered";
    const std::string id = "000" + std::to_string(ablate["rows"].size() + 1);
    Json row = {{"id", id},
                {"part", part},
                {"label", label},
                {"parameters", nullptr},
                {"first_pass", 0},
                {"passes", passes},
                {"metrics", sample_metrics(error)},
                {"mean", 0.25},
                {"change", filtered ? -0.0012 : 0},
                {"neighbors", filtered ? Json(50) : Json()},
                {"seconds", filtered ? Json(0.5) : Json()},
                {"picture", id + ".exr"}};
    if (filtered) row["parameters"] = sample_parameters("8px", "0.333", "all");
    ablate["rows"].push_back(row);
  };
  add("weights", "unfiltered", 0.4, 16);
  add("weights", "no weights", 0.02, 16);
  add("weights", "+ normal 0.95", 0.01, 16);
  add("blocks", "16 blocks of 1 pass", 0.03, 16);
  add("blocks", "1 block of 16 passes", 0.015, 16);
  add("iterations", "unfiltered", 4, 1);
  add("iterations", "iteration 1", 0.1, 1);
  add("iterations", "iteration 2", 0.05, 1);
  return ablate;
}

inline void write_json(const std::string& folder, const Json& study) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/" + study.at("kind").get<std::string>() + ".json") << study.dump(1);
}

// With pictures: the k-th row is the reference times 1 + k/16, unfiltered has 0.5 added in every
// other pixel.
inline void write_sample(const std::string& folder, const Json& study) {
  write_json(folder, study);
  film::write_exr(folder + "/reference.exr", sample_picture(1));
  const auto write = [&](const Json& holder, float scale, float offset) {
    film::write_exr(folder + "/" + holder.at("picture").get<std::string>(),
                    sample_picture(scale, offset));
  };
  if (study.at("kind") != "converge") {
    if (study.contains("unfiltered")) write(study.at("unfiltered"), 1, 0.5f);
    float k = 0;
    for (const Json& row : study.at("rows")) write(row, 1 + ++k / 16, 0);
    return;
  }
  float k = 0;
  for (const Json& series : study.at("series")) {
    const float offset = series.at("parameters").is_null() ? 0.5f : 0;
    for (const Json& point : series.at("points")) write(point, 1 + k++ / 16, offset);
  }
}

}  // namespace psf::tests
