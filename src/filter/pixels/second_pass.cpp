#include "filter/pixels/second_pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "filter/pixels/tile.h"

namespace psf::filter {
namespace {

using pixels::kColumns;
using pixels::kRows;
using pixels::Layout;
using pixels::PaddedImages;

constexpr double kNoise = 0.016;        // epsilon of [second], for one path a pixel
constexpr float kAPixelIs = 1 / 64.0f;  // the difference in position that counts as much as 1
constexpr double kLeastShare = 1e-3, kMostTimes = 1e15;
constexpr float kLargest = 100;  // of reflectances and normals, so that squares stay finite

// What is usual in a picture.
struct Scale {
  // The mean of the logarithms of luminances, as a luminance; 0: black. Pixels far below the median
  // count as a thousandth of it, which one bright pixel does not move as it does the mean.
  double radiance = 0;
  double paths = 0;  // mean number of paths of the pixels that have any
};

double pixel_luminance(const PixelStatistics& s, std::size_t pixel) {
  const std::size_t size = s.width * s.height;
  return 0.2126 * double{s.radiance[pixel]} + 0.7152 * double{s.radiance[size + pixel]} +
         0.0722 * double{s.radiance[2 * size + pixel]};
}

Scale scale_of(const PixelStatistics& s) {
  std::vector<double> luminances;
  double paths = 0, logarithms = 0;
  for (std::size_t pixel = 0; pixel < s.width * s.height; ++pixel) {
    const double y = pixel_luminance(s, pixel);
    if (s.paths[pixel] == 0 || !std::isfinite(y)) continue;
    paths += static_cast<double>(s.paths[pixel]);
    luminances.push_back(std::max(0.0, y));
  }
  const auto light =
      std::partition(luminances.begin(), luminances.end(), [](double y) { return y > 0; });
  if (light == luminances.begin()) return {};
  const auto middle = luminances.begin() + (light - luminances.begin()) / 2;
  std::nth_element(luminances.begin(), middle, light);
  const double least = kLeastShare * *middle;
  for (const double y : luminances) logarithms += std::log(std::max(y, least));
  const auto number = static_cast<double>(luminances.size());
  return {std::exp(logarithms / number), paths / number};
}

// What light is divided by, so that its sums over a window are finite floats: a power of 2, which
// rounds nothing.
double unit_of(const Scale& scale) {
  return std::ldexp(1.0, std::ilogb(scale.radiance));
}
double unit_of(const Scale& scale, const PixelPlane& plane) {
  return plane.colour == PixelPlane::kNoLight ? 1 : unit_of(scale);
}

// The images of the second pass, from statistics and planes.
class Input {
 public:
  Input(const PixelStatistics& statistics, std::span<const PixelPlane> planes, const Scale& scale)
      : s_(statistics),
        size_(s_.width * s_.height),
        layout_{3 + planes.size()},
        images_(s_.width, s_.height, Layout::kPlanes + layout_.plane_count) {
    set_counts(scale);
    set_radiance(scale);
    set_features();
    // The light itself, then the planes.
    for (std::size_t c = 0; c < 3; ++c) {
      set_plane(c, std::span(s_.radiance).subspan(c * size_, size_), unit_of(scale));
    }
    for (std::size_t p = 0; p < planes.size(); ++p) {
      set_plane(3 + p, planes[p].values, unit_of(scale, planes[p]));
    }
  }

  [[nodiscard]] const Layout& layout() const { return layout_; }
  [[nodiscard]] const PaddedImages& images() const { return images_; }
  [[nodiscard]] bool counts(std::size_t pixel) const { return counts_[pixel]; }

 private:
  // Sets an image of which `value` says what is at a pixel.
  template <class Value>
  void set(std::size_t image, const Value& value) {
    float* values = images_.image(image);
    for (std::size_t y = 0; y < s_.height; ++y) {
      for (std::size_t x = 0; x < s_.width; ++x) {
        values[images_.place(x, y)] = static_cast<float>(value(y * s_.width + x));
      }
    }
  }

  void set_counts(const Scale& scale) {
    counts_.resize(size_);
    const double most = kMostTimes * scale.radiance;
    for (std::size_t pixel = 0; pixel < size_; ++pixel) {
      bool counts = s_.paths[pixel] > 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t at = c * size_ + pixel;
        counts = counts && std::abs(double{s_.radiance[at]}) < most &&
                 double{s_.variance[at]} < most * most;  // NaN fails
      }
      counts_[pixel] = counts;
    }
    set(Layout::kCounts, [this](std::size_t pixel) { return counts_[pixel] ? 1 : 0; });
  }

  void set_radiance(const Scale& scale) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto relative = [&](const std::vector<float>& of, double unit) {
        return [this, &of, unit, c](std::size_t pixel) {
          return counts_[pixel] ? double{of[c * size_ + pixel]} / unit : 0;
        };
      };
      set(Layout::kRadiance + c, relative(s_.radiance, scale.radiance));
      set(Layout::kVariance + c, relative(s_.variance, scale.radiance * scale.radiance));
      images_.extend(Layout::kRadiance + c);
      images_.extend(Layout::kVariance + c);
    }
  }

  void set_features() {
    std::size_t at = Layout::kFeatures;
    for (const std::vector<float>* of : {&s_.reflectance, &s_.normal}) {
      for (std::size_t c = 0; c < 3; ++c) {
        set(at++, [&](std::size_t pixel) {
          return std::clamp((*of)[c * size_ + pixel], -kLargest, kLargest);
        });
      }
    }
    set(at++, [this](std::size_t pixel) { return s_.vertices[pixel]; });
    for (std::size_t c = 0; c < 3; ++c) {
      set(at++, [&](std::size_t pixel) { return s_.position[c * size_ + pixel]; });
    }
    set(Layout::kHasPosition, [this](std::size_t pixel) { return has_position(pixel) ? 1 : 0; });
    set(Layout::kScale, [this](std::size_t pixel) {
      const float least = to_nearest_neighbor(pixel);
      return least > 0 ? kAPixelIs / least : 0;
    });
  }

  [[nodiscard]] bool has_position(std::size_t pixel) const { return s_.vertices[pixel] > 0; }

  // The distance to the nearest position of the four pixels beside this one that is not its own: the
  // size of a pixel where it looks. 0: there is none.
  [[nodiscard]] float to_nearest_neighbor(std::size_t pixel) const {
    if (!has_position(pixel)) return 0;
    constexpr float kNone = std::numeric_limits<float>::max();
    float least = kNone;
    const auto look = [&](bool inside, std::size_t other) {
      if (!inside || !has_position(other)) return;
      float square = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const float d = s_.position[c * size_ + other] - s_.position[c * size_ + pixel];
        square += d * d;
      }
      if (square > 0) least = std::min(least, std::sqrt(square));
    };
    const std::size_t x = pixel % s_.width;
    look(x > 0, pixel - 1);
    look(x + 1 < s_.width, pixel + 1);
    look(pixel >= s_.width, pixel - s_.width);
    look(pixel + s_.width < size_, pixel + s_.width);
    return least < kNone ? least : 0;
  }

  void set_plane(std::size_t p, std::span<const float> values, double unit) {
    // What counts nowhere may be infinite, and 0 times that is NaN.
    set(Layout::kPlanes + p,
        [&](std::size_t pixel) { return counts_[pixel] ? double{values[pixel]} / unit : 0; });
  }

  const PixelStatistics& s_;
  std::size_t size_;
  Layout layout_;
  PaddedImages images_;
  std::vector<bool> counts_;
};

// Where the light of a pixel goes: each colour so far from the weighted mean toward the fit.
std::array<double, 4> steps_of(const pixels::TileFit& tile, std::size_t place) {
  std::array<double, 4> steps = {1, 1, 1, 1};
  for (std::size_t c = 0; c < 3; ++c) {
    const double mean = tile.mean[c * kRows * kColumns + place];
    const double fit = tile.fit[c * kRows * kColumns + place];
    if (fit < 0) steps[c] = mean > 0 ? mean / (mean - fit) : 0;
  }
  return steps;
}

}  // namespace

void second_pass(const PixelStatistics& statistics, std::span<const PixelPlane> planes) {
  const Scale scale = scale_of(statistics);
  if (!(scale.radiance > 0) || planes.empty()) return;
  const Input input(statistics, planes, scale);
  const auto noise = static_cast<float>(kNoise / std::sqrt(scale.paths));
  const std::size_t width = statistics.width, height = statistics.height;
  const std::size_t across = core::range_count(width, kColumns);
  const std::size_t tiles = across * core::range_count(height, kRows);
  core::parallel_for(tiles, 1, [&](std::size_t k, std::size_t) {
    const std::size_t left = k % across * kColumns, top = k / across * kRows;
    thread_local pixels::TileFit tile;
    pixels::fit_tile(input.images(), input.layout(), noise, left, top, tile);
    for (std::size_t y = top; y < std::min(height, top + kRows); ++y) {
      for (std::size_t x = left; x < std::min(width, left + kColumns); ++x) {
        if (!input.counts(y * width + x)) continue;
        const std::size_t place = (y - top) * kColumns + x - left;
        const std::array<double, 4> steps = steps_of(tile, place);
        for (std::size_t p = 0; p < planes.size(); ++p) {
          const std::size_t at = (3 + p) * kRows * kColumns + place;
          const double mean = tile.mean[at], step = steps[planes[p].colour];
          planes[p].values[y * width + x] =
              static_cast<float>(unit_of(scale, planes[p]) * (mean + step * (tile.fit[at] - mean)));
        }
      }
    }
  });
}

}  // namespace psf::filter
