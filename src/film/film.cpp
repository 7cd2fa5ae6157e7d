#include "film/film.h"

namespace psf::film {

std::vector<float> Film::mean() const {
  std::vector<float> result(sum_.size(), 0.0f);
  for (std::size_t pixel = 0; pixel < count_.size(); ++pixel) {
    if (count_[pixel] == 0) continue;
    for (std::size_t k = 3 * pixel; k < 3 * pixel + 3; ++k) {
      result[k] = static_cast<float>(sum_[k] / static_cast<double>(count_[pixel]));
    }
  }
  return result;
}

}  // namespace psf::film
