// Attribution a pixel's light came: what a term's absence and presence would give, and leaks that
// were put there are found.
#include "explain/attribution.h"

#include <array>
#include <optional>

#include "catch.h"
#include "explain_setup.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

TEST_CASE("The pixel without a term, and with another, is the picture without it and with it") {
  const filter::BallFit fit = GENERATE(filter::BallFit::mean, filter::BallFit::linear);
  const TempFolder folder;
  write_dump(folder / "a.pvb", random_records(900, 6, 0, kOne), {kOne, {300, 300, 300}, {}});
  const run::Dump dump(folder / "a.pvb");
  FilterRequest run = default_run("1pass");
  run.parameters.weights = terms_of(1 + 4);
  run.parameters.fit = fit;
  if (fit == filter::BallFit::linear) run.parameters.engine = filter::EngineKind::brute;  // exact
  const auto picture_with = [&](const filter::WeightTerms& terms) {
    FilterRequest other = run;
    other.parameters.weights = terms;
    return filtered(folder / "a.pvb", other).front();
  };
  const film::Image without[] = {picture_with(terms_of(4)), {}, picture_with(terms_of(1))};
  std::size_t wrong = 0;
  std::array<std::size_t, filter::kTermCount> proposed{};
  for_pixels(dump, run, [&](std::size_t, std::uint32_t pixel, const auto& explanation) {
    const explain::Attribution whence = explain::attribute(explanation);
    for (const explain::TermRefusals& of : whence.refusals) {
      wrong += is_close(of.without, colour_at(without[of.term], "", pixel)) ? 0u : 1u;
    }
    for (const explain::Remedy& remedy : whence.remedies) {
      if (++proposed[remedy.term] > 3) continue;
      filter::WeightTerms terms = run.parameters.weights;
      const std::array<std::optional<float>*, 8> thresholds = {
          &terms.normal, &terms.reflectance, nullptr, &terms.hit_distance,
          &terms.plane,  &terms.direction,   nullptr, &terms.gloss};
      if (thresholds[remedy.term] != nullptr) *thresholds[remedy.term] = remedy.threshold;
      terms.material = terms.material || remedy.term == 6;
      wrong += is_close(remedy.pixel, colour_at(picture_with(terms), "", pixel)) ? 0u : 1u;
    }
  });
  CHECK(wrong == 0);
  for (const std::size_t term : std::array<std::size_t, 7>{0, 1, 3, 4, 5, 6, 7})
    CHECK(proposed[term] > 0);
  CHECK(proposed[2] == 0);  // it is on
}

TEST_CASE("Records are never told apart by terms that depend on where they are seen from") {
  const TempFolder folder;
  write_dump(folder / "a.pvb", random_records(900, 6, 0, kOne), {kOne, {300, 300, 300}, {}});
  const run::Dump dump(folder / "a.pvb");
  FilterRequest run = default_run("1pass");
  run.parameters.sources = 8;  // the others are orphans where no source in the ball will do
  run.parameters.weights = filter::WeightTerms::none();
  run.parameters.weights.hit_distance = 0.01f;
  run.parameters.weights.direction = 0.999f;
  run.parameters.weights.gloss = 0.01f;
  constexpr std::uint32_t kOfViews = 1u << 3 | 1u << 5 | 1u << 7;
  std::uint32_t refusers = 0, kinds = 0;
  for_pixels(dump, run, [&](std::size_t, std::uint32_t, const auto& explanation) {
    for (const auto& pair : explanation.pairs) refusers |= pair.averaged ? pair.refusers : 0;
    for (const explain::KindShare& kind : explain::attribute(explanation).kinds)
      kinds |= kind.terms;
  });
  CHECK((refusers & kOfViews) == kOfViews);  // orphans averaged what each of them refuses
  CHECK((kinds & kOfViews) == 0);
  CHECK(kinds != 0);
}

TEST_CASE("A shadow's border that leaks is told by its lights, and what refuses it is named") {
  const TempFolder folder;
  write_dump(folder / "a.pvb", half_lit_floor(), {kOne, {200, 200, 200, 200}, {}});
  const run::Dump dump(folder / "a.pvb");
  FilterRequest run = default_run("all");
  run.parameters.radius = {0.35, filter::RadiusBasis::world, 0};
  run.parameters.weights = filter::WeightTerms::none();
  const auto explanation = explain::explain(dump, request_of(run, 0, 11, 5));
  const explain::Attribution whence = explain::attribute(explanation);
  REQUIRE(whence.pixel.own);
  CHECK(whence.pixel.own->x == 0.125);
  CHECK(whence.pixel.own_error == 0);
  CHECK(whence.pixel.difference.x > 0.1);
  CHECK(is_close(whence.pixel.difference, whence.pixel.filtered - *whence.pixel.own));
  // Every source of the leak is lit, and only lit sources raise it.
  REQUIRE(whence.leak > 0);
  for (std::size_t k = 0; k < whence.sources.size(); ++k) {
    const bool lit = explanation.vertices.visibility[whence.sources[k].vertex] == 1;
    CHECK(lit == (k < whence.leak));
  }
  REQUIRE(whence.kinds.size() == 2);
  CHECK(whence.kinds[0].terms == 4);  // visibility
  CHECK(whence.kinds[0].leaking == whence.kinds[0].pairs);
  CHECK(whence.kinds[1].terms == 0);
  CHECK(whence.kinds[1].leaking == 0);
  REQUIRE(whence.remedies.size() >= 1);
  CHECK(whence.remedies[0].term == 2);
  CHECK(whence.remedies[0].leaking == whence.leak_pairs);
  CHECK(whence.remedies[0].others == 0);
  CHECK(is_close(whence.remedies[0].pixel, *whence.pixel.own));
  // With it on there is nothing left to explain.
  run.parameters.weights.visibility = true;
  const explain::Attribution cured =
      explain::attribute(explain::explain(dump, request_of(run, 0, 11, 5)));
  CHECK(is_close(cured.pixel.difference, Colour(0, 0, 0)));
  REQUIRE(cured.refusals.size() == 1);
  CHECK(cured.refusals[0].alone == whence.leak_pairs);
  CHECK(is_close(cured.refusals[0].without, whence.pixel.filtered));
}

TEST_CASE("The noise of a pixel's own paths is that of what is averaged, not of the rest") {
  const TempFolder folder;
  RecordSet set = half_lit_floor();
  const std::size_t pixel = 5 * 20 + 11;
  for (std::size_t pass = 0; pass < 4; ++pass) {
    const float c = 0.1f * static_cast<float>(pass + 1);
    set.contribution[pass * 200 + pixel] = Rgb(c, c, c);
  }
  set.unfiltered[pixel] = Rgb(5, 5, 5);
  write_dump(folder / "a.pvb", set, {kOne, {200, 200, 200, 200}, {}});
  FilterRequest run = default_run("all");
  run.parameters.radius.r0 = 0;
  const auto explanation = explain::explain(run::Dump(folder / "a.pvb"), request_of(run, 0, 11, 5));
  const explain::PixelSums sums = explain::attribute(explanation).pixel;
  REQUIRE(sums.own);
  CHECK(is_close(sums.own->x, 0.25 + 5.0 / 4));
  // 0.1 to 0.4: deviations 0.15, 0.05, 0.05, 0.15.
  CHECK(is_close(sums.own_error, std::sqrt((2 * 0.0225 + 2 * 0.0025) / 3 / 4)));
  CHECK(sums.brightest == 0);
  CHECK(is_close(sums.brightest_share, 5.1 / 6));
}

TEST_CASE("A firefly is one source that makes up the difference") {
  const TempFolder folder;
  RecordSet set = half_lit_floor();
  for (Rgb& c : set.contribution) c = Rgb(0.125f, 0.125f, 0.125f);
  constexpr std::size_t kFirefly = 200 + 5 * 20 + 12;
  set.contribution[kFirefly] = Rgb(90, 90, 90);
  write_dump(folder / "a.pvb", set, {kOne, {200, 200, 200, 200}, {}});
  FilterRequest run = default_run("all");
  run.parameters.radius = {0.3, filter::RadiusBasis::world, 0};
  const auto explanation = explain::explain(run::Dump(folder / "a.pvb"), request_of(run, 0, 11, 5));
  const explain::Attribution whence = explain::attribute(explanation);
  REQUIRE(whence.leak == 1);
  CHECK(explanation.record[whence.sources[0].vertex] == kFirefly);
  CHECK(whence.sources[0].paths == 4);
  CHECK(whence.pixels[0].pixel == 5 * 20 + 12);
}

}  // namespace
}  // namespace psf
