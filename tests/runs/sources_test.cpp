// The picture without filter of a share of the paths: right on average in every pixel, whatever its
// paths meet, and with something to show where none was chosen.
#include <array>
#include <cmath>
#include <random>

#include "catch.h"
#include "filter_dump_setup.h"
#include "run/many_dump.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

constexpr std::size_t kSourceSide = 8, kSourcePixels = kSourceSide * kSourceSide;
const std::vector<filter::CameraView> kSourceCamera = {{kSourceSide, kSourceSide, 0.05}};

FilterRequest run_with(std::uint32_t sources, filter::Estimator estimator) {
  FilterRequest run;
  run.parameters.radius = {0, filter::RadiusBasis::world};
  filter::set_parameter(run.parameters, "block", "all");
  run.parameters.weights = filter::WeightTerms::none();
  run.parameters.sources = sources;
  run.parameters.estimator = estimator;
  return run;
}

// The share of a pixel's paths that meets a surface; it grows with the column from none to all.
double share_of_surface(std::size_t pixel) {
  return static_cast<double>(pixel % kSourceSide) / (kSourceSide - 1);
}
constexpr double kSky = 1, kBefore = 0.5, kReflected = 3;  // means of u, u and alpha c
double truth(std::size_t pixel) {
  const double surface = share_of_surface(pixel);
  return surface * (kBefore + kReflected) + (1 - surface) * kSky;
}

RecordSet render(std::size_t passes, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::exponential_distribution<float> noise;
  std::uniform_real_distribution<double> unit(0, 1);
  RecordSet set(passes * kSourcePixels);
  for (std::size_t i = 0; i < set.size(); ++i) {
    set.pixel[i] = static_cast<std::uint32_t>(i % kSourcePixels);
    const bool surface = unit(random) < share_of_surface(set.pixel[i]);
    set.flags[i] = surface ? 3 : 0;
    set.unfiltered[i] = surface ? Rgb(1, 1, 1) * 0.5f : Rgb(1, 1, 1) * noise(random);
    set.throughput[i] = Rgb(0.5f, 0.5f, 0.5f);
    set.contribution[i] = surface ? Rgb(6, 6, 6) * noise(random) : Rgb(0, 0, 0);
  }
  return set;
}

// One path in three of each pixel, by the pixel and the pass.
bool is_shaded(std::size_t i) {
  return (i % kSourcePixels + 2 * (i % kSourcePixels / kSourceSide) + i / kSourcePixels) % 3 == 0;
}
void shade_one_in_three(RecordSet& set, bool flags_say_so) {
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (!is_shaded(i)) set.flags[i] &= 1;
    if (is_shaded(i) && flags_say_so) set.flags[i] |= 2;
  }
}

// For each pixel the mean over many renders of what `picture` returns, minus the truth, in standard
// errors.
struct Deviations {
  std::array<double, kSourcePixels> off{}, relative{};

  [[nodiscard]] double most() const {
    double most = 0;
    for (const double t : off) most = std::max(most, std::abs(t));
    return most;
  }
};
template <typename Picture>
Deviations deviations(const Picture& picture) {
  constexpr std::size_t kRenders = 150;
  std::array<double, kSourcePixels> sum{}, sum_sq{};
  for (std::uint32_t seed = 1; seed <= kRenders; ++seed) {
    const std::vector<float> green = picture(seed);
    for (std::size_t k = 0; k < kSourcePixels; ++k) {
      sum[k] += double{green[k]};
      sum_sq[k] += double{green[k]} * double{green[k]};
    }
  }
  Deviations result;
  for (std::size_t k = 0; k < kSourcePixels; ++k) {
    const double mean = sum[k] / kRenders;
    const double error = std::sqrt((sum_sq[k] / kRenders - mean * mean) / (kRenders - 1));
    result.off[k] = (mean - truth(k)) / error;
    result.relative[k] = mean / truth(k) - 1;
  }
  return result;
}

// Among normal deviations of 64 pixels, a set in 3,000 has one of more than 4.4.
constexpr double kMost = 4.4;

std::vector<float> unfiltered(const std::string& path, const FilterRequest& run) {
  return *filtered(path, run)[0].find("unfiltered-input.G");
}

TEST_CASE("A share of the sources gives each pixel the mean of all paths, sky and surface alike") {
  const TempFolder folder;
  using filter::Estimator;
  struct Case {
    std::uint32_t sources;
    Estimator estimator;
  };
  for (const Case& one : {Case{1, Estimator::average}, Case{4, Estimator::average},
                          Case{7, Estimator::hash}, Case{4, Estimator::control}}) {
    INFO("1/" << one.sources << ", estimator " << static_cast<int>(one.estimator));
    const Deviations got = deviations([&](std::uint32_t seed) {
      write_dump(folder / "a.pvb", render(16, seed),
                 {kSourceCamera, std::vector<std::size_t>(16, kSourcePixels), {}});
      return unfiltered(folder / "a.pvb", run_with(one.sources, one.estimator));
    });
    CHECK(got.most() < kMost);
  }
}

TEST_CASE("So does a dump in which one path in three is shaded") {
  const TempFolder folder;
  for (const bool says_so : {true, false}) {
    for (const std::uint32_t sources : {1u, 2u}) {
      INFO((says_so ? "the flags say so of the sky too" : "they do not") << ", 1/" << sources);
      const Deviations got = deviations([&](std::uint32_t seed) {
        RecordSet set = render(24, seed);
        shade_one_in_three(set, says_so);
        DumpOptions options{kSourceCamera, std::vector<std::size_t>(24, kSourcePixels), {}};
        options.shade_rate = says_so ? 3 : 1;
        write_dump(folder / "a.pvb", set, options);
        return unfiltered(folder / "a.pvb", run_with(sources, filter::Estimator::average));
      });
      if (says_so) {
        CHECK(got.most() < kMost);
      } else {
        // On average; in a pixel how many paths count depends a little on what they meet.
        double sum = 0;
        for (const double relative : got.relative) {
          CHECK(std::abs(relative) < 0.35);
          sum += relative;
        }
        CHECK(std::abs(sum / kSourcePixels) < 0.03);
      }
    }
  }
}

TEST_CASE("Of a surface as bright as the sky nothing can be seen, however few paths are chosen") {
  const TempFolder folder;
  RecordSet set = render(3, 9);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const bool surface = set.flags[i] != 0;
    set.unfiltered[i] = surface ? Rgb(0, 0, 0) : Rgb(2, 2, 2);
    set.contribution[i] = Rgb(4, 4, 4);
  }
  write_dump(folder / "a.pvb", set,
             {kSourceCamera, std::vector<std::size_t>(3, kSourcePixels), {}});
  for (const std::uint32_t sources : {1u, 2u, 16u, 50u}) {
    CHECK(unfiltered(folder / "a.pvb", run_with(sources, filter::Estimator::average)) ==
          std::vector<float>(kSourcePixels, 2.0f));
  }
}

TEST_CASE("A pixel without any path is black, and a sweep has the same picture without filter") {
  const TempFolder folder;
  RecordSet set = render(3, 10);
  for (std::uint32_t& pixel : set.pixel) pixel = pixel % 2 == 0 ? pixel : pixel - 1;
  write_dump(folder / "a.pvb", set,
             {kSourceCamera, std::vector<std::size_t>(3, kSourcePixels), {}});
  const FilterRequest run = run_with(5, filter::Estimator::average);
  const std::vector<float> picture = unfiltered(folder / "a.pvb", run);
  std::size_t bright = 0;
  for (std::size_t k = 0; k < kSourcePixels; ++k) {
    if (k % 2 == 1) CHECK(picture[k] == 0);
    bright += picture[k] > 0 ? 1u : 0u;
  }
  CHECK(bright > kSourcePixels / 3);
  run::ManyRequest many;
  many.parameters = run.parameters;
  const std::vector<filter::Radius> radii = {run.parameters.radius,
                                             {1, filter::RadiusBasis::world}};
  many.radii = radii;
  const run::ManyResult outcome = run::filter_many(run::Dump(folder / "a.pvb"), many);
  // Whatever the unit of a radius, it is told in pixels.
  CHECK(outcome.last_radius[1] == Approx(1 / 0.05 / std::pow(3, 1.0 / 6)));
  const std::vector<Rgb> swept = outcome.pictures[0].unfiltered();
  for (std::size_t k = 0; k < kSourcePixels; ++k) CHECK(swept[k].y == picture[k]);
}

}  // namespace
}  // namespace psf
