#include "metrics/plane.h"

#include <algorithm>
#include <cassert>

namespace psf::metrics {
namespace {

constexpr std::size_t kRows = 16;  // a piece of parallel work

std::size_t radius_of(const Kernel& kernel) {
  assert(kernel.size() % 2 == 1);
  return kernel.size() / 2;
}

// A chunk of weighted sums over what source(k), k = 0 ... size - 1, points to. Two weights at a
// time: half the traffic of the sums.
template <class Source>
void weigh(const Kernel& kernel, const Source& source, float* out) {
  float sum[Plane::kChunk];
  const float* first = source(0);
  for (std::size_t i = 0; i < Plane::kChunk; ++i) sum[i] = kernel[0] * first[i];
  for (std::size_t k = 1; k < kernel.size(); k += 2) {
    const float *a = source(k), *b = source(k + 1);
    const float weight_a = kernel[k], weight_b = kernel[k + 1];
    for (std::size_t i = 0; i < Plane::kChunk; ++i) sum[i] += weight_a * a[i] + weight_b * b[i];
  }
  std::copy(sum, sum + Plane::kChunk, out);
}

}  // namespace

Plane along_rows(const Plane& plane, const Kernel& kernel) {
  const std::size_t radius = radius_of(kernel), width = plane.width(), stride = plane.stride();
  Plane result(width, plane.height());
  core::parallel_for(plane.height(), kRows, [&](std::size_t begin, std::size_t end) {
    std::vector<float> extended(stride + 2 * radius);
    for (std::size_t y = begin; y < end; ++y) {
      const float* in = plane.row(y);
      const auto middle = extended.begin() + static_cast<std::ptrdiff_t>(radius);
      std::fill(extended.begin(), middle, in[0]);
      std::copy(in, in + width, middle);
      std::fill(middle + static_cast<std::ptrdiff_t>(width), extended.end(), in[width - 1]);
      float* out = result.row(y);
      for (std::size_t x = 0; x < stride; x += Plane::kChunk) {
        weigh(
            kernel, [&](std::size_t k) { return extended.data() + x + k; }, out + x);
      }
    }
  });
  return result;
}

Plane along_columns(const Plane& plane, const Kernel& kernel) {
  const std::size_t radius = radius_of(kernel), height = plane.height();
  Plane result(plane.width(), height);
  core::parallel_for(height, kRows, [&](std::size_t begin, std::size_t end) {
    std::vector<const float*> rows(kernel.size());
    for (std::size_t y = begin; y < end; ++y) {
      for (std::size_t k = 0; k < kernel.size(); ++k) {
        const std::size_t below = y + k;
        rows[k] = plane.row(std::clamp(below, radius, radius + height - 1) - radius);
      }
      float* out = result.row(y);
      for (std::size_t x = 0; x < plane.stride(); x += Plane::kChunk) {
        weigh(
            kernel, [&](std::size_t k) { return rows[k] + x; }, out + x);
      }
    }
  });
  return result;
}

}  // namespace psf::metrics
