#include "film/film.h"

#include "core/parallel.h"

namespace psf::film {

constexpr std::size_t kGrain = 16384;  // pixels

std::vector<float> Film::mean() const {
  std::vector<float> result(sum_.size(), 0.0f);
  core::parallel_for(count_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t pixel = begin; pixel < end; ++pixel) {
      if (count_[pixel] == 0) continue;
      for (std::size_t k = 3 * pixel; k < 3 * pixel + 3; ++k) {
        result[k] = static_cast<float>(sum_[k] / static_cast<double>(count_[pixel]));
      }
    }
  });
  return result;
}

}  // namespace psf::film
