// Fireflies of an explanation against their equations; terms that refuse what they give.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "catch.h"
#include "explain/pairs.h"
#include "explain_setup.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

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
