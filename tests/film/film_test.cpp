// The film is the mean over the paths of each pixel.
#include "film/film.h"

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
