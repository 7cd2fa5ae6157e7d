// The film is the mean over the paths of each pixel.
#include "film/film.h"

#include <random>

#include "catch.h"

using psf::Rgb;
using psf::film::Film;

TEST_CASE("a pixel is the mean of its paths; a pixel without path is black") {
  Film film(2, 1);
  film.add(1, Rgb(1, 2, 3));
  film.add(1, Rgb(3, 4, 8));
  CHECK(film.mean() == std::vector<float>{0, 0, 0, 2, 3, 5.5f});
}

TEST_CASE("a million small values after a large one are not lost") {
  Film film(1, 1);
  film.add(0, Rgb(1e6f));
  for (int i = 0; i < 999999; ++i) film.add(0, Rgb(0.25f));
  CHECK(film.mean()[0] == Approx((1e6 + 0.25 * 999999) / 1e6).epsilon(1e-7));
}

TEST_CASE("a pixel without path is filled from the smallest aligned square that has one") {
  std::mt19937 random(1);
  for (const std::size_t width : {1u, 5u, 16u, 37u}) {
    const std::size_t height = 21;
    Film film(width, height);
    std::vector<double> sum(width * height), count(width * height);
    for (std::size_t k = 0; k < width * height / 7 + 1; ++k) {
      const auto pixel = static_cast<std::uint32_t>(random() % (width * height));
      const auto value = static_cast<float>(random() % 64);
      film.add(pixel, Rgb(value, 2 * value, 0));
      sum[pixel] += double{value};
      count[pixel] += 1;
    }
    const std::vector<float> filled = film.filled_mean(), mean = film.mean();
    for (std::size_t pixel = 0; pixel < width * height; ++pixel) {
      double of = 0, paths = 0;
      for (std::size_t side = 1; paths == 0; side *= 2) {
        for (std::size_t k = 0; k < width * height; ++k) {
          const bool inside =
              k % width / side == pixel % width / side && k / width / side == pixel / width / side;
          of += inside ? sum[k] : 0;
          paths += inside ? count[k] : 0;
        }
      }
      CHECK(film.has_path(pixel) == (count[pixel] > 0));
      CHECK(double{filled[3 * pixel]} == Approx(of / paths).epsilon(1e-6));
      CHECK(double{filled[3 * pixel + 1]} == Approx(2 * of / paths).epsilon(1e-6));
      if (count[pixel] > 0) CHECK(filled[3 * pixel] == mean[3 * pixel]);
    }
  }
  CHECK(Film(4, 3).filled_mean() == std::vector<float>(36, 0.0f));
}
