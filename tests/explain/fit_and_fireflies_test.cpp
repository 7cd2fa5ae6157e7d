// Fits and fireflies, explained: weights, what is kept and what is given, one by one.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "catch.h"
#include "explain/pairs.h"
#include "explain_setup.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

constexpr std::size_t kSide = 20, kRecords = kSide * kSide;
const std::vector<filter::CameraView> kSquare = {{kSide, kSide, 0.05}};

// A bent sheet that one pass looks at, a path a pixel, alpha 1 and u 0: a picture of it is c_bar.
RecordSet sheet(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  RecordSet set(kRecords);
  for (std::size_t i = 0; i < kRecords; ++i) {
    set.pixel[i] = static_cast<std::uint32_t>(i);
    const float x = unit(random), z = unit(random);
    set.position[i] = Vec3(x, 0.1f * x * x, z);
    set.normal[i] = Vec3(-0.2f * x, 1, 0).normalized();
    set.contribution[i] = Rgb(0.5f + x + 0.3f * unit(random), 1 + unit(random), 2 + z);
    set.reflectance[i] = Rgb(0.3f + 0.5f * z, 0.5f, x > 0.5f ? 0.0f : 0.7f);
    if (i % 57 == 3) set.contribution[i] *= 20 + 300 * unit(random);
  }
  return set;
}

FilterRequest sheet_run(filter::BallFit fit, filter::FireflyRule rule) {
  FilterRequest run = default_run("all");
  run.parameters.radius = {0.25, filter::RadiusBasis::world, 0};
  run.parameters.weights = filter::WeightTerms::none();
  run.parameters.engine = filter::EngineKind::brute;
  run.parameters.fit = fit;
  run.parameters.fireflies = rule;
  return run;
}

constexpr filter::FireflyRule kKeep = {}, kSpread = {filter::FireflyRule::Kind::spread},
                              kClamp = {filter::FireflyRule::Kind::clamp, 3};

explain::ExplainResult explain_path(const run::Dump& dump, const FilterRequest& run,
                                    std::uint64_t path) {
  explain::ExplainRequest request = request_of(run, 0, 0, 0);
  request.path = path;
  return explain::explain(dump, request);
}

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

// The equations of [fireflies] in double, without weights.
struct NaiveFirefly {
  double luminance = 0, ordinary = 0, kept = 1, reach = 0;
  std::vector<std::size_t> to;
};
std::vector<NaiveFirefly> naive_fireflies(const RecordSet& set, double r) {
  const auto distance = [&set](std::size_t i, std::size_t j) {
    return (triple_of(set.position[i]) - triple_of(set.position[j])).length();
  };
  std::vector<NaiveFirefly> all(set.size());
  for (std::size_t j = 0; j < set.size(); ++j) {
    const Colour c = triple_of(set.contribution[j]);
    all[j].luminance = 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
  }
  for (std::size_t j = 0; j < set.size(); ++j) {
    double roots = 0, count = 0;
    for (std::size_t k = 0; k < set.size(); ++k) {
      if (distance(j, k) >= r) continue;
      roots += std::sqrt(all[k].luminance);
      ++count;
    }
    all[j].ordinary = roots / count * (roots / count);
    const double levels = std::log(all[j].luminance / (8 * all[j].ordinary)) / std::log(4.0);
    all[j].kept = 1 - std::clamp(levels, 0.0, 1.0);
  }
  for (std::size_t j = 0; j < set.size(); ++j) {
    if (all[j].kept == 1) continue;
    std::vector<double> kind(4, std::numeric_limits<double>::infinity());
    for (std::size_t k = 0; k < set.size(); ++k) {
      if (k == j || all[k].kept == 1 || 4 * all[k].luminance < all[j].luminance) continue;
      kind.push_back(distance(j, k));
    }
    std::sort(kind.begin(), kind.end());
    all[j].reach = std::min(std::max(kind[3], std::min(r / 2, 2 * kind[3])), 4 * r);
    for (std::size_t i = 0; i < set.size(); ++i) {
      // The fourth of its kind is within.
      if (distance(i, j) <= all[j].reach * (1 + 5e-7)) all[j].to.push_back(i);
    }
  }
  return all;
}

TEST_CASE("Fireflies of an explanation, and whom they give what, are those of the equations") {
  const TempFolder folder;
  RecordSet set = sheet(3);
  const std::vector<NaiveFirefly> naive = naive_fireflies(set, 0.25);
  // Also where squares of lengths are no floats.
  const double unit = GENERATE(1.0, 0x1p-90);
  for (Vec3& x : set.position) x *= static_cast<float>(unit);
  write_dump(folder / "a.pvb", set, {kSquare, {kRecords}, {}});
  const run::Dump dump(folder / "a.pvb");
  FilterRequest run = sheet_run(filter::BallFit::mean, kSpread);
  run.parameters.radius.r0 *= unit;
  std::size_t wrong = 0, own = 0, outside = 0;
  for (std::uint32_t i = 0; i < kRecords; ++i) {
    const auto e = explain_path(dump, run, i);
    std::vector<std::uint64_t> givers, expected;
    for (const explain::ExplainedPair& pair : e.pairs) {
      const NaiveFirefly& of = naive[e.record[pair.vertex]];
      const auto* firefly = explain::firefly_at(e, pair.vertex);
      wrong += (firefly != nullptr) == (of.kept < 1) ? 0u : 1u;
      if (pair.given > 0) {
        givers.push_back(e.record[pair.vertex]);
        outside += pair.in_ball ? 0u : 1u;
        const double share = (1 - of.kept) / static_cast<double>(of.to.size());
        wrong += is_close(double{pair.given}, share, 1e-5) ? 0u : 1u;
      }
      if (firefly == nullptr) continue;
      own += pair.self ? 1u : 0u;
      wrong += is_close(double{firefly->luminance}, of.luminance) ? 0u : 1u;
      wrong += is_close(firefly->ordinary, of.ordinary, 1e-5) ? 0u : 1u;
      wrong += is_close(double{firefly->kept}, of.kept, 1e-5) ? 0u : 1u;
      wrong += is_close(double{firefly->reach} / unit, of.reach, 1e-5) ? 0u : 1u;
      wrong += firefly->sources == of.to.size() ? 0u : 1u;
    }
    for (std::size_t j = 0; j < naive.size(); ++j) {
      if (std::count(naive[j].to.begin(), naive[j].to.end(), i) > 0) expected.push_back(j);
    }
    wrong += givers == expected ? 0u : 1u;
  }
  CHECK(wrong == 0);
  CHECK(own > 3);
  CHECK(outside > 50);
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

TEST_CASE("A term that parts a firefly from a pixel takes what it gives, too") {
  const TempFolder folder;
  RecordSet set = half_lit_floor();
  for (Rgb& c : set.contribution) c = Rgb(0.125f, 0.125f, 0.125f);
  constexpr std::size_t kFirefly = 200 + 5 * 20 + 8;  // lit; the pixel is not
  set.contribution[kFirefly] = Rgb(90, 90, 90);
  write_dump(folder / "a.pvb", set, {kOne, {200, 200, 200, 200}, {}});
  const run::Dump dump(folder / "a.pvb");
  FilterRequest run = default_run("all");
  run.parameters.radius = {0.2, filter::RadiusBasis::world, 0};
  run.parameters.weights = filter::WeightTerms::none();
  run.parameters.fireflies = kSpread;
  const explain::ExplainResult e = explain::explain(dump, request_of(run, 0, 12, 5));
  const explain::Attribution whence = explain::attribute(e);
  REQUIRE(whence.leak == 1);
  const explain::SourceShare& firefly = whence.sources[0];
  CHECK(e.record[firefly.vertex] == kFirefly);
  CHECK(firefly.share == firefly.given);  // it keeps nothing, and is in no ball
  CHECK(firefly.paths == 4);
  CHECK(is_close(firefly.given, whence.pixel.given));
  REQUIRE(!whence.remedies.empty());
  CHECK(whence.remedies[0].term == 2);  // visibility
  CHECK(whence.remedies[0].leaking == 4);
  CHECK(is_close(whence.remedies[0].pixel, Colour(0.125, 0.125, 0.125)));
}

}  // namespace
}  // namespace psf
