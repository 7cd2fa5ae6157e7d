// What the loop over passes keeps of cameras, of paths that are traced together, and of their times.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/parallel.h"
#include "render/camera/camera.h"
#include "render/loop/recorder.h"
#include "render/loop/vertex_table.h"
#include "render/sample/sampler.h"
#include "render/sample/sampler_hash.h"
#include "render/scene/scene.h"

namespace psf::render {

constexpr std::size_t kGrain = 1024;  // paths a task

// A camera's place among the paths of a pass.
struct View {
  CameraRays rays;
  std::uint32_t width, height;
  std::uint64_t first;  // path of the pass
  // Whether the time of paths is drawn, and from when to when on, as rays have it.
  bool blurs;
  float opens, closes;
  [[nodiscard]] std::size_t pixels() const { return std::size_t{width} * height; }
};

// Room for the layers of one path.
class LayerSpace {
 public:
  explicit LayerSpace(std::size_t layers)
      : values_(2 * layers),
        sums_{std::span(values_).first(layers), std::span(values_).last(layers)} {}
  [[nodiscard]] const LayerSums& cleared() {
    std::fill(values_.begin(), values_.end(), Rgb(0, 0, 0));
    return sums_;
  }

 private:
  std::vector<Rgb> values_;
  LayerSums sums_;
};

// What a slab of paths gives to the file.
struct Slab {
  Slab(std::size_t paths, std::span<const LayerInfo> layers,
       std::span<const formats::Channel> channels)
      : records(paths, layers, channels), vertices(core::range_count(paths, kGrain)) {}
  Recorder records;
  std::vector<std::vector<VertexRow>> vertices;  // of each task
};

// A position on the film as a float in its pixel: rounding must not take it to the next one.
[[nodiscard]] inline float in_pixel(float position, std::uint32_t pixel) {
  return std::min(position, std::nextafter(static_cast<float>(pixel + 1), 0.0f));
}

// The sets of light paths of a frame are its own.
[[nodiscard]] inline SamplerSettings light_sampler(SamplerSettings settings, std::uint32_t frame) {
  if (frame > 0) settings.seed = mix(settings.seed + frame * kGolden);
  return settings;
}

// Where the scene's shutter is, between 0 and 1, at this time of a camera's.
[[nodiscard]] inline float shutter_time(const Scene& scene, float time) {
  const float length = scene.shutter.close - scene.shutter.open;
  return std::clamp((time - scene.shutter.open) / length, 0.0f, 1.0f);
}

}  // namespace psf::render
