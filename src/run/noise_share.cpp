#include "run/noise_share.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "filter/blocks.h"
#include "run/block_loop.h"
#include "run/median_around.h"
#include "run/pixel_bands.h"

namespace psf::run {
namespace {

constexpr std::size_t kNoiseGrain = 4096;  // pixels

// In double: luminances of any floats, and their squares.
double luminance_of(const Rgb& c) {
  return 0.2126 * double{c.x} + 0.7152 * double{c.y} + 0.0722 * double{c.z};
}

}  // namespace

NoiseMoments::NoiseMoments(const filter::CameraView& camera)
    : width_(camera.width), height_(camera.height), pixels_(width_ * height_) {
  static_assert(sizeof(Pixel) == kBytesAPixel);
}

void NoiseMoments::add(std::uint32_t pixel, const Rgb& u, const Rgb& alpha_c) {
  const double x = luminance_of(u), y = luminance_of(alpha_c);
  if (!std::isfinite(x) || !std::isfinite(y)) return;
  // Welford 1962.
  Pixel& p = pixels_[pixel];
  const auto n = static_cast<double>(++p.paths);
  const double from_u = x - p.u, from_s = y - p.s;
  p.u += from_u / n;
  p.s += from_s / n;
  p.uu += from_u * (x - p.u);
  p.ss += from_s * (y - p.s);
  p.us += from_u * (y - p.s);
}

std::vector<double> NoiseMoments::guess() const {
  std::vector<double> means(pixels_.size());
  std::transform(pixels_.begin(), pixels_.end(), means.begin(), [](const Pixel& p) {
    return p.paths > 0 ? p.u + p.s : std::numeric_limits<double>::quiet_NaN();
  });
  return median_around(means, width_);
}

NoiseShare NoiseMoments::share(double epsilon) const {
  const std::vector<double> g = guess();
  std::vector<NoiseShare> parts(core::range_count(pixels_.size(), kNoiseGrain));
  core::parallel_for(pixels_.size(), kNoiseGrain, [&](std::size_t begin, std::size_t end) {
    NoiseShare& part = parts[begin / kNoiseGrain];
    for (std::size_t k = begin; k < end; ++k) {
      const Pixel& p = pixels_[k];
      if (p.paths < 2) continue;
      const auto n = static_cast<double>(p.paths);
      const double weight = 1 / ((n - 1) * n * (g[k] * g[k] + epsilon));
      part.unfiltered += weight * p.uu;
      part.contribution += weight * p.ss;
      part.covariance += weight * 2 * p.us;
      ++part.pixels;
    }
  });
  NoiseShare all;
  for (const NoiseShare& part : parts) {
    all.unfiltered += part.unfiltered;
    all.contribution += part.contribution;
    all.covariance += part.covariance;
    all.pixels += part.pixels;
  }
  const double pixels = std::max(1.0, static_cast<double>(all.pixels));
  all.unfiltered /= pixels;
  all.contribution /= pixels;
  all.covariance /= pixels;
  return all;
}

void add_noise(const filter::Records& records, std::span<const filter::Role> roles,
               std::size_t first, std::size_t last, std::span<NoiseMoments> moments) {
  for_each_by_pixel(records, first, last, [&](std::size_t, std::span<const std::size_t> some) {
    for (const std::size_t i : some) {
      if (!filter::is_input(roles[i])) continue;
      const bool source = roles[i] == filter::Role::source;
      const Rgb u = records.unfiltered.empty() ? Rgb(0, 0, 0) : records.unfiltered[i];
      const Rgb s = source ? records.throughput[i] * records.contribution[i] : Rgb(0, 0, 0);
      moments[records.camera.empty() ? 0 : records.camera[i]].add(records.pixel[i], u, s);
    }
  });
}

std::vector<NoiseShare> noise_shares(const Dump& dump, const PassSelection& passes, double epsilon,
                                     std::uint32_t sources) {
  filter::Parameters parameters;  // what no term and no radius asks for is not read
  parameters.radius.basis = filter::RadiusBasis::world;
  parameters.block.passes = 1;
  parameters.weights = filter::WeightTerms::none();
  parameters.sources = sources;
  BlockLoop blocks(dump, dump.select(parameters, false), parameters.block, parameters.radius.count,
                   passes.first);
  blocks.set_last(last_pass(dump, passes), true);
  std::vector<NoiseMoments> moments;
  for (const filter::CameraView& camera : dump.cameras()) moments.emplace_back(camera);
  const bool more = blocks.visit_whole([&](const BlockLoop::Visit& visit) {
    filter::Statistics unused;
    const filter::Roles roles = filter::find_roles(visit.records, visit.block, parameters, unused);
    add_noise(visit.records, roles.of, 0, visit.records.size(), moments);
  });
  assert(!more);  // blocks of a pass are whole
  static_cast<void>(more);
  std::vector<NoiseShare> shares;
  shares.reserve(moments.size());
  for (const NoiseMoments& one : moments) shares.push_back(one.share(epsilon));
  return shares;
}

}  // namespace psf::run
