// What the tests of explained pixels share.
#pragma once

#include <cmath>
#include <random>
#include <string>

#include "explain/attribution.h"
#include "explain/explain.h"
#include "runs/filter_dump_setup.h"

namespace psf::tests {

using explain::Colour;

inline explain::ExplainRequest request_of(const FilterRequest& run, std::size_t camera,
                                          std::uint32_t x, std::uint32_t y) {
  explain::ExplainRequest request;
  request.parameters = run.parameters;
  request.passes = run.passes;
  request.camera = camera;
  request.x = x;
  request.y = y;
  return request;
}

inline bool is_close(double a, double b, double tolerance = 1e-6) {
  return std::abs(a - b) <= tolerance * (1 + std::abs(b));
}
inline bool is_close(const Colour& a, const Colour& b) {
  return is_close(a.x, b.x) && is_close(a.y, b.y) && is_close(a.z, b.z);
}
inline Colour triple_of(const Vec3& v) {
  return {double{v.x}, double{v.y}, double{v.z}};
}
inline Colour colour_at(const film::Image& image, const std::string& prefix, std::size_t pixel) {
  return triple_of(image.rgb(prefix)[pixel]);
}

// Calls check(camera, pixel, explanation) for every pixel of a dump, or every `step`-th.
template <typename Check>
void for_pixels(const run::Dump& dump, const FilterRequest& run, Check check,
                std::uint32_t step = 1) {
  for (std::size_t camera = 0; camera < dump.cameras().size(); ++camera) {
    const filter::CameraView& view = dump.cameras()[camera];
    for (std::uint32_t pixel = 0; pixel < view.width * view.height; pixel += step) {
      check(
          camera, pixel,
          explain::explain(dump, request_of(run, camera, pixel % view.width, pixel / view.width)));
    }
  }
}

// A floor, the left half of which sees a light; a pixel of 8 paths each, four passes.
inline RecordSet half_lit_floor() {
  RecordSet set(std::size_t{4} * 200);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const auto place = static_cast<std::uint32_t>(i % 200);
    set.pixel[i] = place;
    const bool lit = place % 20 < 10;
    const auto pass = static_cast<float>(i / 200);
    set.position[i] = Vec3(0.1f * static_cast<float>(place % 20) + 0.01f * pass, 0,
                           0.1f * static_cast<float>(place / 20) + 0.013f * pass);
    set.visibility[i] = lit ? 1 : 0;
    set.contribution[i] = lit ? Rgb(1, 1, 1) : Rgb(0.125f, 0.125f, 0.125f);
  }
  return set;
}

inline constexpr std::size_t kSide = 20, kRecords = kSide * kSide;
inline const std::vector<filter::CameraView> kSquare = {{kSide, kSide, 0.05}};

// A bent sheet that one pass looks at, a path a pixel, alpha 1 and u 0: a picture of it is c_bar.
inline RecordSet sheet(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  RecordSet set(kRecords);
  for (std::size_t i = 0; i < kRecords; ++i) {
    set.pixel[i] = static_cast<std::uint32_t>(i);
    const float x = unit(random), z = unit(random);
    set.position[i] = Vec3(x, 0.1f * x * x, z);
    set.normal[i] = Vec3(-0.2f * x, 1, 0).normalized();
    set.contribution[i] = Rgb(0.5f + x + 0.3f * unit(random), 1 + unit(random), 2 + z);
    set.reflectance[i] = Rgb(0.3f + 0.5f * z, 0.5f, x > 0.5f ? 0.0f : 0.7f);
    if (i % 57 == 3) set.contribution[i] *= 20 + 300 * unit(random);
  }
  return set;
}

inline FilterRequest sheet_run(filter::BallFit fit, filter::FireflyRule rule) {
  FilterRequest run = default_run("all");
  run.parameters.radius = {0.25, filter::RadiusBasis::world, 0};
  run.parameters.weights = filter::WeightTerms::none();
  run.parameters.engine = filter::EngineKind::brute;
  run.parameters.fit = fit;
  run.parameters.fireflies = rule;
  return run;
}

inline constexpr filter::FireflyRule kKeep = {}, kSpread = {filter::FireflyRule::Kind::spread},
                                     kClamp = {filter::FireflyRule::Kind::clamp, 3};

inline explain::ExplainResult explain_path(const run::Dump& dump, const FilterRequest& run,
                                           std::uint64_t path) {
  explain::ExplainRequest request = request_of(run, 0, 0, 0);
  request.path = path;
  return explain::explain(dump, request);
}

}  // namespace psf::tests
