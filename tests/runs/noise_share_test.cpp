// u's share of the noise agrees with sums written from its definition, and with noise that is
// known.
#include "run/noise_share.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "../filter/record_set.h"
#include "catch.h"
#include "core/parallel.h"
#include "temp_folder.h"
#include "write_dump.h"

namespace psf {
namespace {

using run::NoiseShare;
using tests::RecordSet;

double luminance_of(const Rgb& c) {
  return 0.2126 * double{c.x} + 0.7152 * double{c.y} + 0.0722 * double{c.z};
}

// u and alpha c of every path, by pixel of one camera.
struct Paths {
  std::vector<std::vector<std::array<double, 2>>> of_pixel;
  Paths(const RecordSet& set, std::size_t camera, std::size_t pixels) : of_pixel(pixels) {
    for (std::size_t i = 0; i < set.flags.size(); ++i) {
      if (set.camera[i] != camera || set.flags[i] == filter::kHasVertex) continue;
      const bool vertex = (set.flags[i] & filter::kHasVertex) != 0;
      const Rgb s = set.throughput[i] * set.contribution[i];
      of_pixel[set.pixel[i]].push_back(
          {luminance_of(set.unfiltered[i]), vertex ? luminance_of(s) : 0});
    }
  }
};

// [noise], in two passes over the paths of each pixel.
NoiseShare by_definition(const RecordSet& set, std::size_t camera, std::size_t width,
                         std::size_t height) {
  const Paths paths(set, camera, width * height);
  std::vector<double> mean(width * height);
  for (std::size_t k = 0; k < mean.size(); ++k) {
    for (const auto& [u, s] : paths.of_pixel[k])
      mean[k] += (u + s) / static_cast<double>(paths.of_pixel[k].size());
  }
  NoiseShare result;
  for (std::size_t k = 0; k < mean.size(); ++k) {
    const auto& own = paths.of_pixel[k];
    if (own.size() < 2) continue;
    std::vector<double> around;
    for (std::size_t other = 0; other < mean.size(); ++other) {
      const auto dx = static_cast<double>(other % width) - static_cast<double>(k % width);
      const auto dy = static_cast<double>(other / width) - static_cast<double>(k / width);
      if (std::max(std::abs(dx), std::abs(dy)) <= 2 && !paths.of_pixel[other].empty())
        around.push_back(mean[other]);
    }
    std::sort(around.begin(), around.end());
    const double g = around[around.size() / 2], n = static_cast<double>(own.size());
    double mean_u = 0, mean_s = 0;
    for (const auto& [u, s] : own) {
      mean_u += u / n;
      mean_s += s / n;
    }
    for (const auto& [u, s] : own) {
      const double weight = 1 / ((g * g + 0.01) * n * (n - 1));
      result.unfiltered += weight * (u - mean_u) * (u - mean_u);
      result.contribution += weight * (s - mean_s) * (s - mean_s);
      result.covariance += weight * 2 * (u - mean_u) * (s - mean_s);
    }
    ++result.pixels;
  }
  const auto pixels = static_cast<double>(result.pixels);
  result.unfiltered /= pixels;
  result.contribution /= pixels;
  result.covariance /= pixels;
  return result;
}

constexpr std::size_t kSide = 16, kPixels = kSide * kSide;
const std::vector<filter::CameraView> kCamera = {{kSide, kSide, 0.01}};

// Every pixel with so many paths, all with a vertex, alpha 1, u and c 0.
RecordSet plain_records(std::size_t passes) {
  RecordSet set(passes * kPixels);
  for (std::size_t i = 0; i < set.flags.size(); ++i) {
    set.pixel[i] = static_cast<std::uint32_t>(i % kPixels);
    set.throughput[i] = Rgb(1, 1, 1);
    set.contribution[i] = set.unfiltered[i] = Rgb(0, 0, 0);
  }
  return set;
}

NoiseShare share_of(const RecordSet& set, const std::string& path) {
  const std::size_t passes = set.flags.size() / kPixels;
  tests::write_dump(path, set, {kCamera, std::vector<std::size_t>(passes, kPixels), {}});
  return run::noise_shares(run::Dump(path), {})[0];
}

TEST_CASE("The parts of the noise agree with their definition, for each camera") {
  const tests::TempFolder folder;
  const std::vector<filter::CameraView> cameras = {{16, 8, 0.05}, {8, 9, 0.1}};
  const RecordSet set = tests::random_records(2000, 5, 0, cameras);
  tests::write_dump(folder / "a.pvb", set, {cameras, {700, 700, 600}, {}});
  const auto with_threads = [&](std::size_t threads) {
    const core::ThreadLimit limit(threads);
    return run::noise_shares(run::Dump(folder / "a.pvb"), {});
  };
  const auto shares = with_threads(1), more = with_threads(4);
  REQUIRE(shares.size() == 2);
  for (std::size_t camera = 0; camera < 2; ++camera) {
    const NoiseShare right =
        by_definition(set, camera, cameras[camera].width, cameras[camera].height);
    CHECK(shares[camera].pixels == right.pixels);
    CHECK(shares[camera].unfiltered == Approx(right.unfiltered).epsilon(1e-9));
    CHECK(shares[camera].contribution == Approx(right.contribution).epsilon(1e-9));
    CHECK(shares[camera].covariance == Approx(right.covariance).epsilon(1e-6));
    CHECK(more[camera].unfiltered == shares[camera].unfiltered);
    CHECK(more[camera].covariance == shares[camera].covariance);
  }
}

TEST_CASE(
    "Noise of u alone is all u's, noise of c alone none of it, and without noise there is "
    "no share") {
  const tests::TempFolder folder;
  std::mt19937 random(3);
  std::exponential_distribution<float> value;
  RecordSet set = plain_records(8);
  CHECK(std::isnan(share_of(set, folder / "none.pvb").share()));
  RecordSet of_c = set;
  for (std::size_t i = 0; i < set.flags.size(); ++i) {
    set.unfiltered[i] = Rgb(1, 1, 1) * value(random);
    of_c.contribution[i] = Rgb(1, 1, 1) * value(random);
  }
  CHECK(share_of(set, folder / "u.pvb").share() == 1);
  CHECK(share_of(of_c, folder / "c.pvb").share() == 0);
}

TEST_CASE("Independent noise of known variances is shared as these are") {
  const tests::TempFolder folder;
  std::mt19937 random(4);
  std::normal_distribution<float> of_u(2, 1), of_c(3, 2);
  RecordSet set = plain_records(64);
  for (std::size_t i = 0; i < set.flags.size(); ++i) {
    set.unfiltered[i] = Rgb(1, 1, 1) * of_u(random);
    set.contribution[i] = Rgb(1, 1, 1) * of_c(random);
  }
  const NoiseShare share = share_of(set, folder / "a.pvb");
  CHECK(share.share() == Approx(0.2).margin(0.01));
  CHECK(share.variance() == Approx(5.0 / 64 / (25 + 0.01)).epsilon(0.05));
}

TEST_CASE("Sky and surface of the same radiance make no noise, and none is laid on either") {
  const tests::TempFolder folder;
  std::mt19937 random(5);
  RecordSet set = plain_records(16);
  for (std::size_t i = 0; i < set.flags.size(); ++i) {
    const bool sky = random() % 2 == 0;
    set.flags[i] = sky ? 0 : 3;
    set.unfiltered[i] = sky ? Rgb(1, 1, 1) : Rgb(0, 0, 0);
    set.contribution[i] = sky ? Rgb(0, 0, 0) : Rgb(1, 1, 1);
  }
  const NoiseShare share = share_of(set, folder / "a.pvb");
  CHECK(std::isnan(share.share()));
  CHECK(share.unfiltered > 0.01);
  // All that is left with a darker surface is the edge, whatever the surface makes up for.
  for (Rgb& c : set.contribution) c *= 0.5f;
  CHECK(share_of(set, folder / "b.pvb").share() == 1);
}

TEST_CASE("A bright path cannot hide its noise by raising what it is measured against") {
  const tests::TempFolder folder;
  std::mt19937 random(6);
  std::exponential_distribution<float> value;
  RecordSet set = plain_records(16);
  for (Rgb& c : set.contribution) c = Rgb(1, 1, 1) * value(random);
  const double before = share_of(set, folder / "a.pvb").variance();
  set.unfiltered[5 * kPixels + 100] = Rgb(1, 1, 1) * 1e4f;
  const NoiseShare share = share_of(set, folder / "b.pvb");
  CHECK(share.share() > 0.99);
  // Mean 625, spread 2500: of 256 pixels of about 1, 1e8 / 16 / 16 / 256.
  CHECK(share.variance() - before == Approx(1526).epsilon(0.5));
}

}  // namespace
}  // namespace psf
