// [fireflies] against its equations, and what must hold of it.
#include "filter/fireflies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "catch.h"
#include "core/error.h"
#include "core/parallel.h"
#include "engine_case.h"
#include "estimator_case.h"
#include "oracle.h"

namespace psf {
namespace {

using filter::EngineKind;
using filter::Estimates;
using filter::FireflyRule;
using tests::EngineCase;
using tests::inner;
using tests::kEngines;
using tests::minus;
using tests::Triple;
using tests::triple;

constexpr FireflyRule kSpread = {FireflyRule::Kind::spread};

double brightness(const Rgb& c) {
  return 0.2126 * double{c.x} + 0.7152 * double{c.y} + 0.0722 * double{c.z};
}

// By the definition of src/filter/README.md, in double, for the terms `material`, `plane`
// and `gloss`.
class Naive {
 public:
  explicit Naive(const EngineCase& c) : c_(c), s_(c.set) {
    for (std::size_t j = 0; j < s_.size(); ++j) bright_.push_back(is_source(j) ? kept_of(j) : 1);
    kept_ = bright_;
    if (c.parameters.fireflies.kind != FireflyRule::Kind::spread) return;
    for (std::size_t j = 0; j < s_.size(); ++j) {
      if (bright_[j] < 1 && is_even(j)) kept_[j] = 1;
    }
  }

  // Mean of what is kept, and gifts.
  [[nodiscard]] std::vector<Triple> c_bar() const {
    std::vector<Triple> result(s_.size(), Triple{});
    for (std::size_t i = 0; i < s_.size(); ++i) {
      std::size_t count = 0;
      Triple sum{};
      for (std::size_t j = 0; j < s_.size(); ++j) {
        if (!is_source(j) || !averages(i, j)) continue;
        ++count;
        for (std::size_t k = 0; k < 3; ++k) sum[k] += kept_[j] * triple(s_.contribution[j])[k];
      }
      for (std::size_t k = 0; k < 3 && count > 0; ++k) result[i][k] = sum[k] / double(count);
    }
    for (std::size_t j = 0; j < s_.size(); ++j) {
      if (kept_[j] < 1 && c_.parameters.fireflies.kind == FireflyRule::Kind::spread)
        give(j, result);
    }
    return result;
  }
  [[nodiscard]] double kept(std::size_t j) const { return kept_[j]; }
  [[nodiscard]] std::size_t even() const { return bright() - fireflies(); }
  [[nodiscard]] std::size_t bright() const {
    return static_cast<std::size_t>(
        std::count_if(bright_.begin(), bright_.end(), [](double kept) { return kept < 1; }));
  }
  [[nodiscard]] std::size_t fireflies() const {
    return static_cast<std::size_t>(
        std::count_if(kept_.begin(), kept_.end(), [](double kept) { return kept < 1; }));
  }

 private:
  [[nodiscard]] bool is_source(std::size_t j) const { return s_.flags[j] == 3; }
  [[nodiscard]] double distance(std::size_t i, std::size_t j) const {
    const Triple d = minus(triple(s_.position[i]), triple(s_.position[j]));
    return std::sqrt(inner(d, d));
  }
  [[nodiscard]] bool passes(std::size_t i, std::size_t j) const {
    const filter::WeightTerms& terms = c_.parameters.weights;
    if (i == j) return true;
    if (terms.material && s_.material[i] != s_.material[j]) return false;
    if (terms.plane) {
      const Triple apart = minus(triple(s_.position[j]), triple(s_.position[i]));
      const double off = std::abs(inner(apart, triple(s_.normal[i])));
      if (!(off <= double{*terms.plane} * double{c_.radius[i]})) return false;
    }
    if (!terms.gloss || s_.roughness[i] == 1) return true;
    const Triple n = minus(triple(s_.normal[i]), triple(s_.normal[j]));
    const Triple o = minus(triple(s_.direction[i]), triple(s_.direction[j]));
    const double width = double{s_.roughness[i]} * double{s_.roughness[i]};
    return std::sqrt(inner(n, n) + 100 * inner(o, o)) <= double{*terms.gloss} * width;
  }
  [[nodiscard]] bool averages(std::size_t i, std::size_t j) const {
    return i == j || (distance(i, j) < double{c_.radius[i]} && passes(i, j));
  }

  [[nodiscard]] double kept_of(std::size_t j) const {
    std::size_t count = 0;
    double roots = 0;
    for (std::size_t k = 0; k < s_.size(); ++k) {
      if (!is_source(k) || !averages(j, k)) continue;
      ++count;
      roots += std::sqrt(std::max(0.0, brightness(s_.contribution[k])));
    }
    const double ordinary = (roots / double(count)) * (roots / double(count));
    const double y = brightness(s_.contribution[j]);
    if (y <= 0) return 1;
    const FireflyRule& rule = c_.parameters.fireflies;
    if (rule.kind == FireflyRule::Kind::clamp) return std::min(1.0, rule.limit * ordinary / y);
    return 1 - std::min(1.0, std::max(0.0, std::log(y / (8 * ordinary)) / std::log(4.0)));
  }

  [[nodiscard]] bool is_kind(std::size_t j, std::size_t k) const {
    return k != j && bright_[k] < 1 &&
           4 * brightness(s_.contribution[k]) >= brightness(s_.contribution[j]) && passes(j, k) &&
           passes(k, j);
  }

  // Offset and its square of every source around j, in twice its radius, and the means of these over
  // all and over its kind.
  [[nodiscard]] bool is_even(std::size_t j) const {
    const double radius = 2 * double{c_.radius[j]};
    std::vector<std::array<double, 4>> all, kind;
    for (std::size_t k = 0; k < s_.size(); ++k) {
      if (k == j || !is_source(k) || !(distance(j, k) < radius)) continue;
      if (!passes(j, k) || !passes(k, j)) continue;
      const Triple d = minus(triple(s_.position[k]), triple(s_.position[j]));
      all.push_back({d[0] / radius, d[1] / radius, d[2] / radius, inner(d, d) / radius / radius});
      if (is_kind(j, k)) kind.push_back(all.back());
    }
    if (kind.size() < 4) return false;
    const auto mean = [](const auto& some, std::size_t axis, double from, int power) {
      double sum = 0;
      for (const auto& one : some) sum += std::pow(one[axis] - from, power);
      return sum / double(some.size());
    };
    double shift = 0, variance = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double center = mean(all, axis, 0, 1);
      shift += std::pow(mean(kind, axis, center, 1), 2);
      variance += mean(all, axis, center, 2);
    }
    const double center = mean(all, 3, 0, 1);
    const double radial = std::pow(mean(kind, 3, center, 1), 2) / mean(all, 3, center, 2);
    return double(kind.size()) * (shift / (variance / 2) + radial) < 12;
  }

  void give(std::size_t j, std::vector<Triple>& to) const {
    std::vector<double> kind;
    for (std::size_t k = 0; k < s_.size(); ++k) {
      if (is_kind(j, k)) kind.push_back(distance(j, k));
    }
    std::sort(kind.begin(), kind.end());
    const double fourth =
        kind.size() < 4 ? std::numeric_limits<double>::infinity() : (1 + 1e-6) * kind[3];
    const double r = double{c_.radius[j]};
    const double reach = std::min(std::max(fourth, std::min(r / 2, 2 * fourth)), 4 * r);
    std::vector<std::size_t> receivers;
    std::size_t sources = 0;
    for (std::size_t i = 0; i < s_.size(); ++i) {
      const bool gets =
          i == j || (s_.flags[i] != 0 && distance(i, j) < reach && passes(i, j) && passes(j, i));
      if (!gets) continue;
      receivers.push_back(i);
      sources += is_source(i) ? 1u : 0u;
    }
    for (const std::size_t i : receivers) {
      for (std::size_t k = 0; k < 3; ++k) {
        to[i][k] += (1 - kept_[j]) * triple(s_.contribution[j])[k] / double(sources);
      }
    }
  }

  const EngineCase& c_;
  const tests::RecordSet& s_;
  std::vector<double> bright_, kept_;  // what brightness alone leaves to each, and what is left
};

// About one contribution in `rarity` is a firefly, of a brightness between 10 and 10^5: most of them
// on one side, with an edge, and others everywhere.
EngineCase some_case(std::size_t count, std::uint32_t seed, float r, bool material, bool gloss,
                     std::uint32_t rarity = 25) {
  EngineCase c(count, seed, 0.2);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  for (std::size_t j = 0; j < count; ++j) {
    const bool is_beside = c.set.position[j].x < 0.15f;
    const std::uint32_t once_in = is_beside ? rarity / 8 + 1 : 2 * rarity;
    const float level = random() % once_in == 0 ? std::pow(10.0f, 1 + 4 * unit(random)) : 1;
    const float red = unit(random);
    c.set.contribution[j] = Rgb(0.5f + red, 1, 1.5f - red) * level;
    // No two fireflies at one place or as far as the reach: rounding must not decide.
    for (int axis = 0; axis < 3; ++axis) c.set.position[j][axis] += 0.01f * unit(random);
  }
  c.radius.assign(count, r);
  c.parameters.weights.material = material;
  if (gloss) c.parameters.weights.gloss = 6.0f;
  c.parameters.fireflies = kSpread;
  return c;
}

TEST_CASE("Fireflies are spread as their equations say, by every engine") {
  std::size_t even = 0;
  for (const float r : {0.2f, 0.35f, 0.9f, 3.0f}) {
    for (const bool material : {false, true}) {
      const EngineCase c = some_case(700, 21, r, material, r < 0.5f);
      const Naive naive(c);
      const std::vector<Triple> expected = naive.c_bar();
      REQUIRE(naive.fireflies() > 4);
      even += naive.even();
      for (const EngineKind engine : kEngines) {
        INFO("radius " << r << ", material " << material << ", engine " << int(engine));
        const Estimates result = c.filtered(engine);
        CHECK(result.statistics.fireflies == naive.fireflies());
        for (std::size_t i = 0; i < c.set.size(); ++i) {
          if (result.neighbors[i] == 0) continue;
          for (std::size_t k = 0; k < 3; ++k) {
            REQUIRE(double{result.c_bar[i][int(k)]} == Approx(expected[i][k]).epsilon(1e-4));
          }
        }
      }
    }
  }
  CHECK(even > 20);
}

// Compares with Naive, by every engine.
void check_all_engines(const EngineCase& c) {
  const Naive naive(c);
  const std::vector<Triple> expected = naive.c_bar();
  REQUIRE(naive.fireflies() > 4);
  double light = 0;
  for (std::size_t j = 0; j < c.set.size(); ++j) {
    if (c.set.flags[j] == 3) light += brightness(c.set.contribution[j]);
  }
  for (const EngineKind engine : kEngines) {
    INFO("engine " << int(engine));
    const Estimates result = c.filtered(engine);
    CHECK(result.statistics.fireflies == naive.fireflies());
    CHECK(result.statistics.light == Approx(light).epsilon(1e-5));
    for (std::size_t i = 0; i < c.set.size(); ++i) {
      if (result.neighbors[i] == 0) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        REQUIRE(double{result.c_bar[i][int(k)]} ==
                Approx(expected[i][k]).epsilon(1e-4).margin(1e-4));
      }
    }
  }
}

TEST_CASE("The kind of a firefly is looked for behind as many dimmer ones as there are") {
  for (const float r : {0.2f, 0.5f, 0.9f}) {
    EngineCase c = some_case(700, 31, r, false, false);
    std::mt19937 random(32);
    std::uniform_real_distribution<float> unit(0, 1);
    // Half as many are twice as bright: of those near the brightest, few are of its kind.
    for (std::size_t j = 0; j < c.set.size(); ++j) {
      const std::uint32_t once_in = c.set.position[j].x < 0.15f ? 3 : 20;
      const bool is_bright = random() % once_in == 0;
      c.set.contribution[j] = Rgb(1, 1, 1) * (is_bright ? 50 / (0.002f + unit(random)) : 1);
    }
    INFO("radius " << r);
    check_all_engines(c);
  }
}

TEST_CASE("Fireflies are off a plane by their radius, not by how far they reach") {
  for (const float r : {0.2f, 0.5f}) {
    EngineCase c = some_case(700, 33, r, false, false);
    c.parameters.weights.plane = 0.45f;
    INFO("radius " << r);
    check_all_engines(c);
  }
}

TEST_CASE("Bright contributions that lie as evenly as all others are averaged with them") {
  EngineCase c = some_case(700, 37, 0.4f, false, false);
  std::mt19937 random(38);
  for (Rgb& one : c.set.contribution) one = Rgb(1, 1, 1) * (random() % 20 == 0 ? 1000.0f : 1.0f);
  const Naive naive(c);
  REQUIRE(naive.bright() > 20);
  c.parameters.fireflies = {};
  const Estimates mean = c.filtered(EngineKind::flann);
  c.parameters.fireflies = kSpread;
  const Estimates spread = c.filtered(EngineKind::flann);
  CHECK(spread.statistics.fireflies * 10 < naive.bright());
  std::size_t same = 0;
  for (std::size_t i = 0; i < c.set.size(); ++i) same += mean.c_bar[i] == spread.c_bar[i] ? 1u : 0u;
  CHECK(same * 10 > 9 * c.set.size());
}

TEST_CASE("Contributions below 0 are no fireflies, and as ordinary as black ones") {
  for (const FireflyRule rule : {kSpread, FireflyRule{FireflyRule::Kind::clamp, 4}}) {
    EngineCase c = some_case(700, 35, 0.3f, false, false);
    for (std::size_t j = 0; j < c.set.size(); j += 5) {
      c.set.contribution[j] = c.set.contribution[j] * (j % 2 == 0 ? -1.0f : 0.0f);
    }
    c.parameters.fireflies = rule;
    check_all_engines(c);
  }
}

TEST_CASE("Spread light is all given out, and where sources are few, as much as a mean gives") {
  for (const double share_unshaded : {0.0, 0.5}) {
    EngineCase c = some_case(3000, 3, 0.2f, true, false);
    std::mt19937 random(1);
    for (std::uint8_t& flags : c.set.flags) {
      if (flags != 0) flags = double(random() % 100) < 100 * share_unshaded ? 1 : 3;
    }
    const Naive naive(c);
    const Estimates spread = c.filtered(EngineKind::flann);
    EngineCase rest = c;  // what is kept alone
    double apart = 0, given = 0;
    std::size_t queries = 0, sources = 0;
    for (std::size_t j = 0; j < c.set.size(); ++j) {
      queries += c.set.flags[j] != 0 ? 1u : 0u;
      if (c.set.flags[j] != 3) continue;
      ++sources;
      apart += (1 - naive.kept(j)) * brightness(c.set.contribution[j]);
      rest.set.contribution[j] = c.set.contribution[j] * static_cast<float>(naive.kept(j));
    }
    rest.parameters.fireflies = {};
    const Estimates kept = rest.filtered(EngineKind::flann);
    for (std::size_t i = 0; i < c.set.size(); ++i) {
      given += brightness(spread.c_bar[i]) - brightness(kept.c_bar[i]);
    }
    CHECK(spread.statistics.light_apart == Approx(apart).epsilon(1e-5));
    CHECK(apart > 0.5 * spread.statistics.light);
    const double stand_for = double(queries) / double(sources);  // each source for so many queries
    CHECK(given / (apart * stand_for) == Approx(1).margin(share_unshaded == 0 ? 1e-5 : 0.05));
  }
}

TEST_CASE(
    "Without fireflies every byte is as without the rule, and a lone firefly stays where it is") {
  EngineCase c = some_case(900, 8, 0.2f, true, false, 1u << 30);
  for (const EngineKind engine : kEngines) {
    c.parameters.fireflies = kSpread;
    const Estimates spread = c.filtered(engine);
    c.parameters.fireflies = {};
    CHECK(tests::difference(spread, c.filtered(engine)) == "");
    CHECK(spread.statistics.fireflies == 0);
  }
  EngineCase alone = some_case(900, 8, 0.0f, true, false, 4);
  for (const EngineKind engine : kEngines) {
    const Estimates result = alone.filtered(engine);
    for (std::size_t i = 0; i < alone.set.size(); ++i) {
      if (alone.set.flags[i] == 3) REQUIRE(result.c_bar[i] == alone.set.contribution[i]);
    }
  }
}

TEST_CASE("Clamped contributions are at most so many times what is ordinary around them") {
  for (const double limit : {1.0, 4.0}) {
    EngineCase c = some_case(700, 5, 0.15f, true, false);
    c.parameters.fireflies = {FireflyRule::Kind::clamp, limit};
    const std::vector<Triple> expected = Naive(c).c_bar();
    for (const EngineKind engine : kEngines) {
      const Estimates result = c.filtered(engine);
      for (std::size_t i = 0; i < c.set.size(); ++i) {
        if (result.neighbors[i] == 0) continue;
        REQUIRE(double{result.c_bar[i].y} == Approx(expected[i][1]).epsilon(1e-4));
      }
    }
  }
  // The limit grows with n, so that nothing is clamped in the end.
  EngineCase c = some_case(700, 5, 0.15f, true, false);
  c.parameters.fireflies = {FireflyRule::Kind::clamp, 4};
  const auto lost = [&](double n) {
    return filter::estimate(c.set.view(), c.radius, {0, n, 1.5, c.cameras}, c.parameters)
        .statistics.light_apart;
  };
  CHECK(lost(16) < lost(1));
  CHECK(lost(1e14) == 0);
}

TEST_CASE("Layers of spread light add up, iterated and demodulated too") {
  EngineCase c = some_case(900, 6, 0.2f, false, false);
  c.parameters.demodulate = true;
  c.parameters.iterations = 2;
  for (const EngineKind engine : kEngines) {
    const Estimates whole = c.filtered(engine);
    const Estimates layered = tests::filtered_in_two(c, engine);
    CHECK(tests::same_bytes(layered.c_bar, whole.c_bar));
    CHECK(whole.statistics.fireflies > 10);
    for (std::size_t i = 0; i < c.set.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const float sum = layered.layers[0][i][k] + layered.layers[1][i][k];
        REQUIRE(sum == Approx(whole.c_bar[i][k]).epsilon(1e-5));
      }
    }
  }
}

TEST_CASE("Spread fireflies are the same bytes for any number of threads, and in any unit") {
  EngineCase c = some_case(20'000, 9, 0.1f, true, false);
  const auto with_threads = [&](std::size_t threads) {
    const core::ThreadLimit limit(threads);
    return c.filtered(EngineKind::flann);
  };
  const Estimates one = with_threads(1);
  for (const std::size_t threads : {2u, 5u}) {
    CHECK(tests::difference(one, with_threads(threads)) == "");
  }
  EngineCase scaled = c;
  for (std::size_t i = 0; i < c.set.size(); ++i) {
    scaled.set.position[i] = c.set.position[i] * 0x1p70f;
    scaled.set.contribution[i] = c.set.contribution[i] * 0x1p-20f;
    scaled.radius[i] = c.radius[i] * 0x1p70f;
  }
  const Estimates far = scaled.filtered(EngineKind::flann);
  for (std::size_t i = 0; i < c.set.size(); ++i)
    REQUIRE(far.c_bar[i].y * 0x1p20f == one.c_bar[i].y);
}

TEST_CASE("What is infinite in a radius reaches everywhere, and still ends") {
  EngineCase c = some_case(500, 2, tests::kInfinity, false, false, 10);
  const std::vector<Triple> expected = Naive(c).c_bar();
  for (const EngineKind engine : kEngines) {
    const Estimates result = c.filtered(engine);
    for (std::size_t i = 0; i < c.set.size(); ++i) {
      if (c.set.flags[i] == 0) continue;
      REQUIRE(double{result.c_bar[i].y} == Approx(expected[i][1]).epsilon(1e-4));
    }
  }
}

TEST_CASE("Fireflies are refused where no mean over a ball is taken") {
  for (const filter::Estimator estimator : tests::all_estimators()) {
    filter::Parameters parameters;
    parameters.estimator = estimator;
    parameters.fireflies = kSpread;
    if (filter::info(estimator).fits) {
      CHECK_NOTHROW(parameters.validate());
    } else {
      CHECK_THROWS_AS(parameters.validate(), Error);
    }
  }
  filter::Parameters parameters;
  parameters.fireflies = {FireflyRule::Kind::clamp, 0.9};
  CHECK_THROWS_AS(parameters.validate(), Error);
}

}  // namespace
}  // namespace psf
