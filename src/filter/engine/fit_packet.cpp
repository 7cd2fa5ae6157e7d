#include "filter/engine/fit_packet.h"

#include <algorithm>

#include "core/parallel.h"

namespace psf::filter::engine {
namespace {

constexpr std::size_t kFitGrain = 256;  // groups

void put(float (&to)[3][kWidth], std::size_t k, const Vec3& v) {
  for (std::size_t axis = 0; axis < 3; ++axis) to[axis][k] = v[static_cast<int>(axis)];
}

// Calls visit(place in the tree's order, record number) for every place of every group; the last
// record is that of all places beyond it.
template <class Visit>
void each_place(const Tree& tree, const Visit& visit) {
  core::parallel_for(tree.nodes(kGroups), kFitGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t place = begin * kWidth; place < end * kWidth; ++place) {
      visit(place, tree.order()[std::min(place, tree.size() - 1)]);
    }
  });
}

}  // namespace

FitSources::FitSources(const Tree& tree, const Records& records)
    : facing_(tree.nodes(kGroups) * 3 * kWidth), luminance_sq_(tree.nodes(kGroups) * kWidth) {
  const std::span<const Vec3> y = filter::facing(records);
  each_place(tree, [&](std::size_t place, std::uint32_t j) {
    float* out = &facing_[place / kWidth * 3 * kWidth + place % kWidth];
    for (int axis = 0; axis < 3; ++axis, out += kWidth) *out = y[j][axis];
  });
}

void FitSources::set_luminance(const Tree& tree, std::span<const Rgb> values) {
  each_place(tree, [&](std::size_t place, std::uint32_t j) {
    const double y = double{luminance(values[j])};
    luminance_sq_[place] = y * y;
  });
}

void FitPacket::set_axes(const Records& records, std::span<const std::uint32_t> queries,
                         std::span<const float> radius) {
  const std::span<const Vec3> y = filter::facing(records);
  for (std::size_t k = 0; k < kWidth; ++k) {
    const std::uint32_t i = queries[std::min(k, queries.size() - 1)];
    const FitAxes axes = fit_axes(records, i, radius[i]);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      put(place[axis], k, axes.place[axis]);
      put(facing[axis], k, axes.facing[axis]);
    }
    put(own, k, y[i]);
  }
}

void FitPacket::set_fit(std::size_t k, double count, double luminance) {
  if (!(count > 0)) {
    at_mean[k] = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) by_place[axis][k] = by_facing[axis][k] = 0;
    return;
  }
  FitMoments moments{count, luminance, luminance_sq[k], {}, {}};
  for (std::size_t f = 0; f < kFeatures; ++f) moments.sum[f] = sum[f][k];
  for (std::size_t p = 0; p < kFeatureProducts; ++p) moments.product[p] = product[p][k];
  const Fit fit = fit_of(moments);
  at_mean[k] = static_cast<float>(fit.at_mean);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto along = [&](const float(&axes)[2][3][kWidth], std::size_t first) {
      return static_cast<float>(fit.slope[first] * double{axes[0][axis][k]} +
                                fit.slope[first + 1] * double{axes[1][axis][k]});
    };
    by_place[axis][k] = along(place, 0);
    by_facing[axis][k] = along(facing, 2);
  }
}

}  // namespace psf::filter::engine
