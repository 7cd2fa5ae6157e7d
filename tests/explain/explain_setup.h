// What the tests of explained pixels share.
#pragma once

#include <cmath>
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

}  // namespace psf::tests
