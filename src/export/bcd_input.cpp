// Histograms and covariances of samples for BCD.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "export/denoiser_input.h"

namespace psf::exports {
namespace {

constexpr std::size_t kBins = 3 * kBcdBins;
// The pairs of components in BCD's order of a symmetric matrix.
constexpr std::array<std::array<std::size_t, 2>, 6> kPairs = {
    {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}};

class BcdInput : public DenoiserInput {
 public:
  explicit BcdInput(const DenoiserSource& source)
      : width_(source.width),
        height_(source.height),
        counts_(source.pixels()),
        sums_(source.pixels()),
        bins_(source.pixels() * kBins) {}

  void add(const run::UnfilteredPath& path) override {
    if (!path.in_picture) return;
    const std::array<double, 3> value = {path.radiance.x, path.radiance.y, path.radiance.z};
    Sums& sums = sums_[path.pixel];
    const double n = ++counts_[path.pixel];
    std::array<double, 3> from_old{}, from_new{};  // differences from the means before and after
    for (std::size_t c = 0; c < 3; ++c) {
      from_old[c] = n > 1 ? value[c] - sums.color[c] / (n - 1) : 0;
      sums.color[c] += value[c];
      from_new[c] = value[c] - sums.color[c] / n;
    }
    for (std::size_t k = 0; k < kPairs.size(); ++k) {
      sums.products[k] += from_old[kPairs[k][0]] * from_new[kPairs[k][1]];
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const double place = bcd_bin_place(value[c]);
      const std::size_t below = std::min(static_cast<std::size_t>(place), kBcdBins - 2);
      const double share = place - static_cast<double>(below);
      double* bin = &bins_[path.pixel * kBins + c * kBcdBins + below];
      bin[0] += 1 - share;
      bin[1] += share;
    }
  }

  void write(PictureFolder& folder) override {
    film::Image color = picture();
    for (std::size_t c = 0; c < 3; ++c) {
      add_plane(color, std::string(1, "RGB"[c]), [&](std::size_t pixel) {
        return counts_[pixel] > 0 ? sums_[pixel].color[c] / counts_[pixel] : 0;
      });
    }
    folder.write_exr("color.exr", std::move(color));
    film::Image covariances = picture();
    for (std::size_t k = 0; k < kPairs.size(); ++k) {
      add_plane(covariances, bin_name(k), [&](std::size_t pixel) {
        return counts_[pixel] > 1 ? sums_[pixel].products[k] / (counts_[pixel] - 1.0) : 0;
      });
    }
    folder.write_exr("color_cov.exr", std::move(covariances));
    film::Image histogram = picture();
    for (std::size_t k = 0; k < kBins; ++k) {
      add_plane(histogram, bin_name(k),
                [&](std::size_t pixel) { return bins_[pixel * kBins + k]; });
    }
    add_plane(histogram, bin_name(kBins),
              [&](std::size_t pixel) { return static_cast<double>(counts_[pixel]); });
    folder.write_exr("color_hist.exr", std::move(histogram));
  }

 private:
  struct Sums {
    std::array<double, 3> color = {};
    std::array<double, 6> products = {};  // of differences from the means, by kPairs
  };

  static std::string bin_name(std::size_t k) { return fmt::format("Bin_{:04}", k); }
  [[nodiscard]] film::Image picture() const {
    film::Image image;
    image.width = width_;
    image.height = height_;
    return image;
  }
  template <class Value>
  void add_plane(film::Image& image, const std::string& channel, const Value& value) const {
    std::vector<float> plane(counts_.size());
    for (std::size_t pixel = 0; pixel < plane.size(); ++pixel) {
      plane[pixel] = static_cast<float>(value(pixel));
    }
    image.layers.push_back({channel, std::move(plane)});
  }

  std::size_t width_, height_;
  std::vector<std::uint32_t> counts_;
  std::vector<Sums> sums_;
  std::vector<double> bins_;  // (pixels, 3, kBcdBins)
};

}  // namespace

double bcd_bin_place(double value) {
  constexpr double kGamma = 2.2, kMost = 2.5, kSaturated = 2;
  const double s = std::min(std::pow(std::max(value, 0.0), 1 / kGamma) / kMost, kSaturated);
  constexpr double kLastButOne = kBcdBins - 2;
  return s < 1 ? s * kLastButOne : kLastButOne + (s - 1) / (kSaturated - 1);
}

std::unique_ptr<DenoiserInput> make_bcd_input(const DenoiserSource& source) {
  return std::make_unique<BcdInput>(source);
}

}  // namespace psf::exports
