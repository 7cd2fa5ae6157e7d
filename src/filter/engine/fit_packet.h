// What [fit] needs of a tree's sources and of a packet's queries.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/buffer.h"
#include "core/vec.h"
#include "filter/engine/tree.h"
#include "filter/fit.h"
#include "filter/records.h"

namespace psf::filter::engine {

// In the order of a tree, for each of its sources.
class FitSources {
 public:
  FitSources(const Tree& tree, const Records& records);
  // Of `values`, by record number, which are averaged.
  void set_luminance(const Tree& tree, std::span<const Rgb> values);

  // y_j of group g, (3, 16), and the squared luminances, (16).
  [[nodiscard]] const float* facing(std::size_t g) const { return &facing_[g * 3 * kWidth]; }
  [[nodiscard]] const double* luminance_sq(std::size_t g) const {
    return &luminance_sq_[g * kWidth];
  }

 private:
  core::Buffer<float> facing_;         // (groups, 3, 16)
  core::Buffer<double> luminance_sq_;  // (groups, 16)
};

// Of the queries of a packet, one per lane. The kernel sets the moments, which are sums over what
// was found; set_fit() makes the weights of them.
struct FitPacket {
  // FitAxes and y_i.
  alignas(64) float place[2][3][kWidth];
  alignas(64) float facing[2][3][kWidth];
  alignas(64) float own[3][kWidth];

  alignas(64) double sum[kFeatures][kWidth];
  alignas(64) double product[kFeatureProducts][kWidth];
  alignas(64) double luminance_sq[kWidth];

  // The weight of source j is at_mean - (x_j - x_i) . by_place - (y_j - y_i) . by_facing.
  alignas(64) float at_mean[kWidth];
  alignas(64) float by_place[3][kWidth];
  alignas(64) float by_facing[3][kWidth];

  void set_axes(const Records& records, std::span<const std::uint32_t> queries,
                std::span<const float> radius);
  // Sets the weights of the query in lane k; without sources, to 0. `count`, `luminance`: the
  // moments that are not here.
  void set_fit(std::size_t k, double count, double luminance);
};

}  // namespace psf::filter::engine
