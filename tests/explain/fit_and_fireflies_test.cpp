// Weights of fits, what is kept and what is given, one by one: they make up the filtered picture.
#include <algorithm>
#include <cmath>

#include "catch.h"
#include "explain/pairs.h"
#include "explain_setup.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

float& channel(Rgb& c, int k) {
  return k == 0 ? c.x : k == 1 ? c.y : c.z;
}

TEST_CASE("Weights times what is kept, and what is given, add up to c_bar in the picture") {
  const TempFolder folder;
  const RecordSet set = sheet(1);
  write_dump(folder / "a.pvb", set, {kSquare, {kRecords}, {}});
  const run::Dump dump(folder / "a.pvb");
  std::size_t wrong = 0, below = 0, held = 0, dimmed = 0, given = 0;
  const auto check = [&](const FilterRequest& run) {
    const bool divides = run.parameters.demodulate;
    const film::Image picture = filtered(folder / "a.pvb", run).front();
    for (std::uint32_t i = 0; i < kRecords; i += 3) {
      const auto e = explain_path(dump, run, i);
      const explain::ExplainedPath& path = e.paths.front();
      const auto rho = [&](std::uint32_t of, int k) {
        const auto value = double{set.reflectance[of][k]};
        return divides && value > 0 ? value : 1.0;
      };
      Colour sum(0, 0, 0), mean(0, 0, 0), weights(0, 0, 0);
      for (const explain::ExplainedPair& pair : e.pairs) {
        const auto j = static_cast<std::uint32_t>(e.record[pair.vertex]);
        const auto* firefly = explain::firefly_at(e, pair.vertex);
        const double kept = firefly != nullptr ? double{firefly->kept} : 1;
        const Colour weight = explain::weight_of(e, pair);
        weights += weight;
        below += weight.x < 0 ? 1u : 0u;
        dimmed += pair.averaged && kept < 1 ? 1u : 0u;
        given += pair.given > 0 ? 1u : 0u;
        for (int k = 0; k < 3; ++k) {
          const double c = double{set.contribution[j][k]} * rho(i, k) / rho(j, k);
          sum[k] += weight[k] * kept * c + double{pair.given} * c;
          if (pair.averaged) mean[k] += kept * c / path.neighbors;
        }
      }
      const Colour expected = colour_at(picture, "", i);
      wrong += is_close(sum, expected) ? 0u : 1u;
      wrong += is_close(weights, Colour(1, 1, 1)) ? 0u : 1u;
      if (!path.fit) continue;
      wrong += is_close(path.fit->mean, mean) ? 0u : 1u;
      for (int k = 0; k < 3; ++k) {
        if (path.fit->taken[k] == 1) continue;
        ++held;
        wrong += std::abs(expected[k] - double{path.given[k]}) < 1e-6 ? 0u : 1u;
      }
    }
  };
  for (const filter::BallFit fit : {filter::BallFit::mean, filter::BallFit::linear}) {
    for (const filter::FireflyRule& rule : {kKeep, kSpread, kClamp}) {
      for (const bool demodulate : {false, true}) {
        FilterRequest run = sheet_run(fit, rule);
        run.parameters.demodulate = demodulate;
        check(run);
        run.parameters.estimator = filter::Estimator::adaptive;
        run.parameters.radius.r0 = 0.6;
        check(run);
      }
    }
  }
  CHECK(wrong == 0);
  CHECK(below > 0);
  CHECK(dimmed > 0);
  CHECK(given > 0);
  // Light that falls steeply to 0, so that what is linear goes below.
  RecordSet steep = set;
  for (std::size_t i = 0; i < kRecords; ++i) {
    const float x = steep.position[i].x;
    steep.contribution[i] = Rgb(x < 0.3f ? 0.0f : 8 * (x - 0.3f), 1, 1);
  }
  write_dump(folder / "b.pvb", steep, {kSquare, {kRecords}, {}});
  const run::Dump falling(folder / "b.pvb");
  const FilterRequest run = sheet_run(filter::BallFit::linear, kKeep);
  const film::Image picture = filtered(folder / "b.pvb", run).front();
  for (std::uint32_t i = 0; i < kRecords; ++i) {
    const auto e = explain_path(falling, run, i);
    Colour sum(0, 0, 0);
    for (const explain::ExplainedPair& pair : e.pairs) {
      sum += explain::weight_of(e, pair) * triple_of(steep.contribution[e.record[pair.vertex]]);
    }
    wrong += is_close(sum, colour_at(picture, "", i)) ? 0u : 1u;
    if (!e.paths[0].fit || e.paths[0].fit->taken.x == 1) continue;
    ++held;
    wrong += std::abs(sum.x) < 1e-6 && e.paths[0].fit->taken.y == 1 ? 0u : 1u;
  }
  CHECK(wrong == 0);
  CHECK(held > 0);
}

// A change of a source's colour that leaves its luminance, and so the ridge, as it is.
TEST_CASE("A weight is how much the filtered picture follows a source") {
  const TempFolder folder;
  const RecordSet set = sheet(2);
  write_dump(folder / "a.pvb", set, {kSquare, {kRecords}, {}});
  const run::Dump dump(folder / "a.pvb");
  const FilterRequest run = sheet_run(filter::BallFit::linear, kKeep);
  const film::Image picture = filtered(folder / "a.pvb", run).front();
  std::size_t wrong = 0, seen = 0;
  double least = 1, most = 0;
  for (const std::uint32_t j : {0u, 111u, 222u, 333u}) {
    RecordSet other = set;
    constexpr float kMore = 0.5f;
    channel(other.contribution[j], 0) += kMore;
    channel(other.contribution[j], 2) -= kMore * 0.2126f / 0.0722f;
    write_dump(folder / "b.pvb", other, {kSquare, {kRecords}, {}});
    const film::Image changed = filtered(folder / "b.pvb", run).front();
    for (std::uint32_t i = 0; i < kRecords; i += 7) {
      const auto e = explain_path(dump, run, i);
      double weight = 0;
      for (const explain::ExplainedPair& pair : e.pairs) {
        if (e.record[pair.vertex] == j) weight = explain::weight_of(e, pair).x;
      }
      const double followed =
          (colour_at(changed, "", i).x - colour_at(picture, "", i).x) / double{kMore};
      wrong += std::abs(followed - weight) < 2e-5 ? 0u : 1u;
      seen += weight != 0 ? 1u : 0u;
      if (weight == 0) continue;
      least = std::min(least, weight * e.paths[0].neighbors);
      most = std::max(most, weight * e.paths[0].neighbors);
    }
  }
  CHECK(wrong == 0);
  CHECK(seen > 20);
  CHECK(least < 0.8);
  CHECK(most > 1.1);
}

TEST_CASE("A pixel made of fits has a mean beside it, which the picture without fit holds") {
  const TempFolder folder;
  write_dump(folder / "a.pvb", sheet(4), {kSquare, {kRecords}, {}});
  const run::Dump dump(folder / "a.pvb");
  for (const filter::FireflyRule& rule : {kKeep, kSpread}) {
    const film::Image means =
        filtered(folder / "a.pvb", sheet_run(filter::BallFit::mean, rule)).front();
    const FilterRequest run = sheet_run(filter::BallFit::linear, rule);
    const film::Image picture = filtered(folder / "a.pvb", run).front();
    std::size_t wrong = 0, apart = 0;
    for_pixels(dump, run, [&](std::size_t, std::uint32_t pixel, const auto& e) {
      const explain::PixelSums sums = explain::attribute(e).pixel;
      wrong += is_close(sums.of_means, colour_at(means, "", pixel)) ? 0u : 1u;
      apart += is_close(sums.of_means, sums.filtered) ? 0u : 1u;
      if (rule.keeps()) return;
      wrong += is_close(sums.given, colour_at(picture, "fireflies.", pixel)) ? 0u : 1u;
    });
    CHECK(wrong == 0);
    CHECK(apart > kRecords / 2);
  }
}

TEST_CASE("With weights of a fit, no source of even light adds to a pixel or takes from it") {
  const TempFolder folder;
  RecordSet set = half_lit_floor();
  for (Rgb& c : set.contribution) c = Rgb(0.125f, 0.25f, 0.5f);
  write_dump(folder / "a.pvb", set, {kOne, {200, 200, 200, 200}, {}});
  FilterRequest run = default_run("all");
  run.parameters.radius = {0.35, filter::RadiusBasis::world, 0};
  run.parameters.weights = filter::WeightTerms::none();
  run.parameters.fit = filter::BallFit::linear;
  const auto e = explain::explain(run::Dump(folder / "a.pvb"), request_of(run, 0, 0, 0));
  double least = 1, most = 0;
  for (const explain::ExplainedPair& pair : e.pairs) {
    const double times = explain::weight_of(e, pair).x * e.paths[pair.path].neighbors;
    least = std::min(least, times);
    most = std::max(most, times);
  }
  CHECK(least < 0.5);  // the pixel is in a corner
  CHECK(most > 1.5);
  const explain::Attribution whence = explain::attribute(e);
  CHECK(whence.sources.size() > 20);
  for (const explain::SourceShare& source : whence.sources) {
    CHECK(source.excess.length() < 1e-9);
    CHECK(source.share.length() > 1e-6);
  }
}

}  // namespace
}  // namespace psf
