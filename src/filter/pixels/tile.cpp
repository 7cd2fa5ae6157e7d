// As in engine/kernel.cpp: compiled once for every instruction set.
#include "filter/pixels/tile.h"

#include <algorithm>

#include "filter/engine/targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/pixels/tile.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace psf::filter::pixels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;
constexpr D kD;
constexpr std::size_t kLanes = hn::MaxLanes(kD), kGroups = kVectors / kLanes;
constexpr std::size_t kSites = kRows + 2 * kPatch;

// How unlike pixels and those at one offset from them are, in units of noise, and the sums over
// patches. A little longer than a row, since its ends are read past.
using Row = float[kVectors + 16];

class Weights {
 public:
  Weights(const PaddedImages& images, float noise) : images_(images), noise_(hn::Set(kD, noise)) {}

  // For the tile whose first pixel is at place `at`, and the offset `to`.
  void set(std::size_t at, std::ptrdiff_t to) {
    const std::size_t stride = images_.stride();
    const std::size_t first = at - stride - kPatch;
    for (std::size_t r = 0; r < kSites; ++r) {
      for (std::size_t j = 0; j < kVectors; j += kLanes) {
        hn::StoreU(unlikeness(first + r * stride + j, to), kD, unlike_[r] + j);
      }
    }
    to_ = to;
  }
  // Of the pixels from column j of row r on, which are at place `at`.
  [[nodiscard]] HWY_INLINE V at(std::size_t at, std::size_t r, std::size_t j) const {
    V sum = hn::Zero(kD);
    for (std::size_t y = 0; y < 3; ++y) {
      for (std::size_t x = 0; x < 3; ++x) {
        sum = hn::Add(sum, hn::LoadU(kD, unlike_[r + y] + j + x));
      }
    }
    const V e = hn::Max(hn::Zero(kD), hn::Mul(sum, hn::Set(kD, 1.0f / (27 * 4))));
    const V q = hn::Max(hn::Zero(kD), hn::Sub(hn::Set(kD, 1), e));
    const V q2 = hn::Mul(q, q);
    const V counts = hn::LoadU(kD, images_.image(Layout::kCounts) + moved(at, to_));
    return hn::Mul(hn::Mul(q2, q2), counts);
  }
  [[nodiscard]] static HWY_INLINE std::size_t moved(std::size_t at, std::ptrdiff_t to) {
    return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at) + to);
  }

 private:
  [[nodiscard]] HWY_INLINE V unlikeness(std::size_t at, std::ptrdiff_t to) const {
    const V k2 = hn::Set(kD, kLikeness * kLikeness);
    V sum = hn::Zero(kD);
    for (std::size_t c = 0; c < 3; ++c) {
      const float* radiance = images_.image(Layout::kRadiance + c);
      const float* variance = images_.image(Layout::kVariance + c);
      const V d = hn::Sub(hn::LoadU(kD, radiance + at), hn::LoadU(kD, radiance + moved(at, to)));
      const V own = hn::LoadU(kD, variance + at), other = hn::LoadU(kD, variance + moved(at, to));
      const V noise = hn::Add(own, hn::Min(other, own));
      const V most = hn::Add(own, hn::Min(other, hn::Mul(hn::Set(kD, kMostNoise), own)));
      const V excess = hn::Sub(hn::Mul(d, d), noise);
      sum = hn::Add(sum, hn::Div(excess, hn::Add(noise_, hn::Mul(k2, most))));
    }
    return sum;
  }

  const PaddedImages& images_;
  V noise_;
  std::ptrdiff_t to_ = 0;
  Row unlike_[kSites] = {};
};

// The moments of a group of kLanes pixels: those of the features with each other and with 1, lower
// triangle row by row, then of each plane with 1 and the features.
struct Moments {
  static constexpr std::size_t kOrder = Layout::kFeatureCount + 1;
  static constexpr std::size_t kOwn = kOrder * (kOrder + 1) / 2;

  [[nodiscard]] static std::size_t count(const Layout& layout) {
    return kOwn + kOrder * layout.plane_count;
  }

  // Adds what pixels at an offset bring.
  static HWY_INLINE void add(const PaddedImages& images, const Layout& layout, std::size_t at,
                             std::size_t other, V weight, float* sums) {
    V feature[kOrder], weighted[kOrder];
    feature[0] = hn::Set(kD, 1);
    for (std::size_t f = 0; f < Layout::kOfPosition; ++f) {
      const float* image = images.image(Layout::kFeatures + f);
      feature[f + 1] = hn::Sub(hn::LoadU(kD, image + other), hn::LoadU(kD, image + at));
    }
    const V scale = hn::Mul(hn::LoadU(kD, images.image(Layout::kScale) + at),
                            hn::LoadU(kD, images.image(Layout::kHasPosition) + other));
    for (std::size_t f = Layout::kOfPosition; f < Layout::kFeatureCount; ++f) {
      const float* image = images.image(Layout::kFeatures + f);
      const V far =
          hn::Mul(scale, hn::Sub(hn::LoadU(kD, image + other), hn::LoadU(kD, image + at)));
      feature[f + 1] = hn::Clamp(far, hn::Set(kD, -kFarthest), hn::Set(kD, kFarthest));
    }
    const auto add_to = [&sums](V value) {
      hn::StoreU(hn::Add(hn::LoadU(kD, sums), value), kD, sums);
      sums += kLanes;
    };
    for (std::size_t i = 0; i < kOrder; ++i) {
      weighted[i] = hn::Mul(weight, feature[i]);
      for (std::size_t j = 0; j <= i; ++j) add_to(hn::Mul(weighted[i], feature[j]));
    }
    for (std::size_t p = 0; p < layout.plane_count; ++p) {
      const V value = hn::LoadU(kD, images.image(Layout::kPlanes + p) + other);
      for (std::size_t i = 0; i < kOrder; ++i) add_to(hn::Mul(weighted[i], value));
    }
  }

  // Solves the fit of one lane by elimination from the last feature to the constant.
  static void solve(const Layout& layout, const float* sums, std::size_t pixel, TileFit& tile) {
    double own[kOrder][kOrder];
    for (std::size_t i = 0; i < kOrder; ++i) {
      for (std::size_t j = 0; j <= i; ++j, sums += kLanes) own[i][j] = double{*sums};
    }
    const double all = own[0][0];
    for (std::size_t i = 1; i < kOrder; ++i) own[i][i] += double{kRidge} * all;
    // own = U D U^T with U upper and of unit diagonal; own[i][j] becomes U_ji, i > j.
    for (std::size_t i = kOrder; i-- > 1;) {
      double share[kOrder];
      for (std::size_t j = 0; j < i; ++j) share[j] = own[i][j] / own[i][i];
      for (std::size_t r = 0; r < i; ++r) {
        for (std::size_t j = 0; j <= r; ++j) own[r][j] -= share[r] * own[i][j];
      }
      std::copy_n(share, i, own[i]);
    }
    for (std::size_t p = 0; p < layout.plane_count; ++p) {
      double right[kOrder];
      for (std::size_t i = 0; i < kOrder; ++i, sums += kLanes) right[i] = double{*sums};
      const std::size_t place = p * kRows * kColumns + pixel;
      tile.mean[place] = right[0] / all;
      for (std::size_t i = kOrder; i-- > 1;) {
        for (std::size_t j = 0; j < i; ++j) right[j] -= own[i][j] * right[i];
      }
      tile.fit[place] = right[0] / own[0][0];
    }
  }
};

void fit_tile_on(const PaddedImages& images, const Layout& layout, float noise, std::size_t x,
                 std::size_t y, TileFit& tile) {
  const std::size_t count = Moments::count(layout) * kLanes;
  tile.sums.assign(kRows * kGroups * count, 0);
  Weights weights(images, noise);
  const std::size_t first = images.place(x, y), stride = images.stride();
  constexpr auto kFar = static_cast<std::ptrdiff_t>(kReach);
  for (std::ptrdiff_t dy = -kFar; dy <= kFar; ++dy) {
    for (std::ptrdiff_t dx = -kFar; dx <= kFar; ++dx) {
      const std::ptrdiff_t to = dy * static_cast<std::ptrdiff_t>(stride) + dx;
      weights.set(first, to);
      for (std::size_t r = 0; r < kRows; ++r) {
        for (std::size_t g = 0; g < kGroups; ++g) {
          const std::size_t at = first + r * stride + g * kLanes;
          const V weight = weights.at(at, r, g * kLanes);
          if (hn::AllTrue(kD, hn::Eq(weight, hn::Zero(kD)))) continue;
          Moments::add(images, layout, at, Weights::moved(at, to), weight,
                       tile.sums.data() + (r * kGroups + g) * count);
        }
      }
    }
  }
  for (std::size_t r = 0; r < kRows; ++r) {
    for (std::size_t j = 0; j < kColumns; ++j) {
      const std::size_t group = r * kGroups + j / kLanes;
      Moments::solve(layout, tile.sums.data() + group * count + j % kLanes, r * kColumns + j, tile);
    }
  }
}

}  // namespace psf::filter::pixels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace psf::filter::pixels {

HWY_EXPORT(fit_tile_on);

PaddedImages::PaddedImages(std::size_t width, std::size_t height, std::size_t images)
    : width_(width),
      height_(height),
      stride_((width + kColumns - 1) / kColumns * kColumns + 2 * kBorder + kVectors),
      size_(stride_ * ((height + kRows - 1) / kRows * kRows + 2 * kBorder)),
      values_(images * size_ + kVectors) {}

void PaddedImages::extend(std::size_t k) {
  float* values = image(k);
  for (std::size_t y = 0; y < height_; ++y) {
    float* row = values + (y + kBorder) * stride_;
    std::fill_n(row, kBorder, row[kBorder]);
    std::fill(row + kBorder + width_, row + stride_, row[kBorder + width_ - 1]);
  }
  const std::size_t rows = size_ / stride_;
  for (std::size_t y = 0; y < rows; ++y) {
    if (y >= kBorder && y < kBorder + height_) continue;
    const std::size_t from = y < kBorder ? kBorder : kBorder + height_ - 1;
    std::copy_n(values + from * stride_, stride_, values + y * stride_);
  }
}

void fit_tile(const PaddedImages& images, const Layout& layout, float noise, std::size_t x,
              std::size_t y, TileFit& tile) {
  tile.mean.resize(layout.plane_count * kRows * kColumns);
  tile.fit.resize(layout.plane_count * kRows * kColumns);
  HWY_DYNAMIC_DISPATCH(fit_tile_on)(images, layout, noise, x, y, tile);
}

}  // namespace psf::filter::pixels
#endif
