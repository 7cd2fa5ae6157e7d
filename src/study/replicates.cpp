#include "study/replicates.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"

namespace psf::study {
namespace {

constexpr std::size_t kPixelGrain = 4096;  // pixels

// Products of the replicates' errors, summed over pixels: everything else follows from them.
// E e_r e_s = bias^2 for r != s, because replicates are independent.
class Products {
 public:
  explicit Products(std::size_t count) : count_(count), sums_(count * count) {}

  void add(const std::vector<double>& errors, double weight) {
    for (std::size_t r = 0; r < count_; ++r) {
      for (std::size_t s = 0; s <= r; ++s) sums_[r * count_ + s] += errors[r] * errors[s] * weight;
    }
  }
  void add_values(double values) { values_ += values; }
  Products& operator+=(const Products& other) {
    for (std::size_t k = 0; k < sums_.size(); ++k) sums_[k] += other.sums_[k];
    values_ += other.values_;
    return *this;
  }

  // Mean over all replicates but `without` (count(): none) of e_r^2, and of e_r e_s for r != s.
  struct Means {
    double square = 0, product = 0;
  };
  [[nodiscard]] Means means(std::size_t without) const {
    Means sums;
    double squares = 0, products = 0;
    for (std::size_t r = 0; r < count_; ++r) {
      if (r == without) continue;
      sums.square += sums_[r * count_ + r];
      ++squares;
      for (std::size_t s = 0; s < r; ++s) {
        if (s == without) continue;
        sums.product += sums_[r * count_ + s];
        ++products;
      }
    }
    return {sums.square / squares / values_, sums.product / products / values_};
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] bool is_empty() const { return values_ == 0; }

 private:
  std::size_t count_;
  std::vector<double> sums_;  // lower triangle
  double values_ = 0;         // three a pixel
};

Products multiply(std::span<const std::vector<Rgb>> replicates, std::span<const Rgb> reference,
                  std::size_t width, double epsilon, const Rectangle& region) {
  const bool everywhere = region.width == 0;
  const auto wanted = [&](std::size_t pixel) {
    const std::size_t x = pixel % width, y = pixel / width;
    return everywhere || (x - region.x < region.width && y - region.y < region.height);
  };
  std::vector<Products> parts(core::range_count(reference.size(), kPixelGrain),
                              Products(replicates.size()));
  core::parallel_for(reference.size(), kPixelGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<double> errors(replicates.size());
    Products& part = parts[begin / kPixelGrain];
    for (std::size_t pixel = begin; pixel < end; ++pixel) {
      const auto finite = [&](const std::vector<Rgb>& one) { return is_finite(one[pixel]); };
      if (!wanted(pixel) || !is_finite(reference[pixel]) ||
          !std::all_of(replicates.begin(), replicates.end(), finite)) {
        continue;
      }
      for (int c = 0; c < 3; ++c) {
        const double r = double{reference[pixel][c]};
        for (std::size_t k = 0; k < replicates.size(); ++k) {
          errors[k] = double{replicates[k][pixel][c]} - r;
        }
        part.add(errors, 1 / (r * r + epsilon));
      }
      part.add_values(3);
    }
  });
  Products all(replicates.size());
  for (const Products& part : parts) all += part;
  return all;
}

// 95% of what `of` estimates, from its values with one replicate left out each.
template <class Of>
Interval jackknife(const Products& products, const Of& of) {
  const std::size_t count = products.count();
  if (count < 3) return {};
  const double all = of(products.means(count));
  const auto n = static_cast<double>(count);
  double sum = 0, squares = 0;
  for (std::size_t r = 0; r < count; ++r) {
    const double pseudo = n * all - (n - 1) * of(products.means(r));
    sum += pseudo;
    squares += pseudo * pseudo;
  }
  const double variance = std::max(0.0, (squares - sum * sum / n) / (n - 1));
  const double reach = student_t(count - 1) * std::sqrt(variance / n);
  return {all - reach, all + reach};
}

}  // namespace

double student_t(std::size_t degrees_of_freedom) {
  // Abramowitz and Stegun, table 26.10; beyond it their expansion 26.7.5, good to 0.001.
  constexpr std::array<double, 10> kTable = {12.706, 4.303, 3.182, 2.776, 2.571,
                                             2.447,  2.365, 2.306, 2.262, 2.228};
  if (degrees_of_freedom == 0) return std::numeric_limits<double>::infinity();
  if (degrees_of_freedom <= kTable.size()) return kTable[degrees_of_freedom - 1];
  constexpr double kNormal = 1.959964;
  const auto f = static_cast<double>(degrees_of_freedom);
  const double x = kNormal, x3 = x * x * x, x5 = x3 * x * x;
  return x + (x3 + x) / (4 * f) + (5 * x5 + 16 * x3 + 3 * x) / (96 * f * f);
}

ErrorParts decompose(std::span<const std::vector<Rgb>> replicates, std::span<const Rgb> reference,
                     std::size_t width, double epsilon, const Rectangle& region) {
  ErrorParts parts;
  const Products products = multiply(replicates, reference, width, epsilon, region);
  if (products.is_empty() || replicates.empty()) return parts;
  const Products::Means means = products.means(products.count());
  parts.error = means.square;
  if (replicates.size() < 2) return parts;
  const auto variance = [](const Products::Means& m) { return m.square - m.product; };
  const auto bias_sq = [](const Products::Means& m) { return m.product; };
  parts.bias_sq = bias_sq(means);
  parts.variance = variance(means);
  parts.bias_sq_interval = jackknife(products, bias_sq);
  parts.variance_interval = jackknife(products, variance);
  return parts;
}

}  // namespace psf::study
