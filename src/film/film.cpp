#include "film/film.h"

#include <algorithm>

#include "core/parallel.h"

namespace psf::film {
namespace {

constexpr std::size_t kGrain = 16384;  // pixels

float mean_of(double sum, std::uint64_t count) {
  return static_cast<float>(sum / static_cast<double>(count));
}

void set_mean(const double* sum, std::uint64_t count, float* to) {
  for (int c = 0; c < 3; ++c) to[c] = mean_of(sum[c], count);
}

// Sums over squares of pixels.
struct Squares {
  std::size_t width, height;
  std::vector<double> sum;  // three each
  std::vector<std::uint64_t> count;

  [[nodiscard]] Squares twice_as_wide() const {
    const std::size_t columns = (width + 1) / 2, rows = (height + 1) / 2;
    Squares larger{columns, rows, std::vector<double>(3 * columns * rows),
                   std::vector<std::uint64_t>(columns * rows)};
    for (std::size_t k = 0; k < count.size(); ++k) {
      const std::size_t to = k / width / 2 * columns + k % width / 2;
      larger.count[to] += count[k];
      for (std::size_t c = 0; c < 3; ++c) larger.sum[3 * to + c] += sum[3 * k + c];
    }
    return larger;
  }
};

}  // namespace

std::vector<float> Film::mean_of_part(std::size_t part) const {
  std::vector<float> result(3 * count_.size(), 0.0f);
  const double* sum = &sum_[3 * part * count_.size()];
  core::parallel_for(count_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t pixel = begin; pixel < end; ++pixel) {
      if (has_path(pixel)) set_mean(sum + 3 * pixel, count_[pixel], &result[3 * pixel]);
    }
  });
  return result;
}

std::vector<float> Film::mean(std::size_t component) const {
  std::vector<float> result(count_.size());
  const double* sum = &sum_[component / 3 * 3 * count_.size() + component % 3];
  for (std::size_t pixel = 0; pixel < count_.size(); ++pixel) {
    if (has_path(pixel)) result[pixel] = mean_of(sum[3 * pixel], count_[pixel]);
  }
  return result;
}

bool Film::has_path_everywhere() const {
  return std::find(count_.begin(), count_.end(), 0) == count_.end();
}

std::vector<float> Film::filled_mean(std::size_t part) const {
  std::vector<float> result = mean_of_part(part);
  std::vector<std::size_t> holes;
  for (std::size_t pixel = 0; pixel < count_.size(); ++pixel) {
    if (!has_path(pixel)) holes.push_back(pixel);
  }
  if (holes.empty()) return result;
  const auto first = sum_.begin() + static_cast<std::ptrdiff_t>(3 * part * count_.size());
  const auto end = first + static_cast<std::ptrdiff_t>(3 * count_.size());
  Squares squares{width_, height_, std::vector<double>(first, end), count_};
  for (std::size_t side = 2; !holes.empty() && squares.count.size() > 1; side *= 2) {
    squares = squares.twice_as_wide();
    std::erase_if(holes, [&](std::size_t pixel) {
      const std::size_t k = pixel / width_ / side * squares.width + pixel % width_ / side;
      if (squares.count[k] == 0) return false;
      set_mean(&squares.sum[3 * k], squares.count[k], &result[3 * pixel]);
      return true;
    });
  }
  return result;
}

}  // namespace psf::film
