// An explained pixel: its numbers are those of the filtered picture, its refusals those that the
// filter counts.
#include "explain/explain.h"

#include <limits>

#include "catch.h"
#include "core/error.h"
#include "explain_setup.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

// Every way to filter that changes a number.
std::vector<std::pair<std::string, FilterRequest>> ways() {
  std::vector<std::pair<std::string, FilterRequest>> list;
  const auto add = [&list](const char* name, const std::string& block, unsigned terms) {
    FilterRequest run = default_run(block);
    run.parameters.weights = terms_of(terms);
    list.emplace_back(name, run);
    return &list.back().second.parameters;
  };
  add("two terms", "2passes", 3);
  add("all terms", "all", 255);
  add("blocks of b^m", "2^6", 1);
  add("demodulated", "1pass", 4)->demodulate = true;
  add("iterated", "all", 4)->iterations = 3;
  add("few sources", "all", 64)->sources = 3;
  filter::Parameters* demodulated = add("demodulated and iterated", "all", 4);
  demodulated->demodulate = true;
  demodulated->iterations = 2;
  add("adaptive", "all", 4)->estimator = filter::Estimator::adaptive;
  add("no radius", "1pass", 3)->radius.r0 = 0;
  add("world", "all", 2)->radius = {0.3, filter::RadiusBasis::world};
  filter::Parameters* footprint = add("footprint", "2passes", 2);
  footprint->radius = {4, filter::RadiusBasis::footprint};
  footprint->radius.count = filter::RadiusCount::blocks;
  // Fits of the plain engine, which are exact.
  const auto linear = [](filter::Parameters* parameters) {
    parameters->fit = filter::BallFit::linear;
    parameters->engine = filter::EngineKind::brute;
    return parameters;
  };
  const auto spread = [](filter::Parameters* parameters) {
    parameters->fireflies = {filter::FireflyRule::Kind::spread};
    return parameters;
  };
  linear(add("fit", "all", 4));
  spread(add("fireflies spread", "2passes", 4));
  add("fireflies clamped", "2passes", 4)->fireflies = {filter::FireflyRule::Kind::clamp, 2};
  spread(linear(add("fit and fireflies, demodulated", "all", 4)))->demodulate = true;
  spread(linear(add("fit and fireflies, adaptive", "all", 68)))->estimator =
      filter::Estimator::adaptive;
  spread(linear(add("fit and fireflies, few sources", "all", 64)))->sources = 3;
  filter::Parameters* both = spread(linear(add("fit and fireflies, iterated", "all", 4)));
  both->demodulate = true;
  both->iterations = 3;
  return list;
}

constexpr std::uint32_t kStep = 7;  // pixels

// Counts, over pixels, the numbers that differ from the picture's, and the cases that were seen.
struct Agreement {
  std::size_t wrong = 0, orphans = 0, all_shaded = 0, given = 0, fitted = 0;

  void expect(bool right) { wrong += right ? 0u : 1u; }

  void add(const explain::ExplainResult& explanation, const film::Image& image,
           std::uint32_t pixel) {
    const explain::Attribution whence = explain::attribute(explanation);
    const auto n = static_cast<double>(whence.pixel.paths);
    Colour sum(0, 0, 0), excess(0, 0, 0);
    double neighbors = 0, radius = 0, vertices = 0;
    for (const explain::ExplainedPath& path : explanation.paths) {
      sum += triple_of(explanation.vertices.unfiltered[path.vertex]) / n;
      if (path.fate == explain::PathFate::no_vertex) continue;
      ++vertices;
      neighbors += path.neighbors;
      radius += double{path.radius};
      std::uint32_t averaged = 0;
      given += path.given.x > 0 ? 1u : 0u;
      fitted += path.fit ? 1u : 0u;
      for (std::size_t p = path.begin; p < path.end; ++p) {
        const explain::ExplainedPair& pair = explanation.pairs[p];
        averaged += pair.averaged && pair.in_ball ? 1u : 0u;
        sum += explain::share_of(explanation, pair, whence.pixel.paths);
      }
      const bool is_orphan = path.fate == explain::PathFate::orphan;
      orphans += is_orphan ? 1u : 0u;
      expect(is_orphan || averaged == path.neighbors);
    }
    for (const explain::SourceShare& source : whence.sources) excess += source.excess;
    const Colour picture = colour_at(image, "", pixel);
    expect(is_close(sum, picture));
    expect(is_close(whence.pixel.filtered, picture));
    expect(is_close(excess, whence.pixel.difference));
    if (vertices > 0) {
      expect(is_close(neighbors / vertices, double{(*image.find("neighbors.Y"))[pixel]}));
      expect(is_close(radius / vertices, double{(*image.find("radius.Y"))[pixel]}));
    }
    const Colour own = colour_at(image, "unfiltered-input.", pixel);
    if (whence.pixel.own) expect(is_close(*whence.pixel.own, own));
    if (whence.pixel.own_paths < explanation.paths.size()) return;
    ++all_shaded;
    expect(is_close(whence.pixel.difference, picture - own));
  }
};

TEST_CASE("Shares, neighbours, radius and own paths of a pixel are those of the picture") {
  const TempFolder folder;
  for (const double unshaded : {0.0, 0.6}) {
    RecordSet set = random_records(1100, 3, unshaded, kTwo);
    for (std::size_t i = 0; i < set.size(); i += 29) set.contribution[i] *= 40;
    write_dump(folder / "a.pvb", set, {kTwo, {400, 400, 300}, {}});
    const run::Dump dump(folder / "a.pvb");
    for (const auto& [name, run] : ways()) {
      const std::vector<film::Image> pictures = filtered(folder / "a.pvb", run);
      Agreement agreement;
      for_pixels(
          dump, run,
          [&](std::size_t camera, std::uint32_t pixel, const explain::ExplainResult& explanation) {
            agreement.add(explanation, pictures[camera], pixel);
          },
          kStep);
      INFO(name << ", " << unshaded << " unshaded");
      CHECK(agreement.wrong == 0);
      if (unshaded == 0 && run.parameters.sources == 1) CHECK(agreement.all_shaded > 0);
      if (unshaded > 0 && run.parameters.radius.r0 == 0) CHECK(agreement.orphans > 0);
      CHECK((agreement.given > 0) == run.parameters.fireflies.spreads());
      CHECK((agreement.fitted > 0) == (run.parameters.fit == filter::BallFit::linear));
    }
  }
}

TEST_CASE("Shares of photon mapping's disk add up to the picture, too") {
  const TempFolder folder;
  write_dump(folder / "a.pvb", random_records(800, 4, 0.3, kOne), {kOne, {400, 400}, {}});
  const run::Dump dump(folder / "a.pvb");
  FilterRequest run = default_run("1pass");
  run.parameters.estimator = filter::Estimator::disk;
  run.parameters.weights = terms_of(4);
  const film::Image picture = filtered(folder / "a.pvb", run).front();
  std::size_t wrong = 0;
  for_pixels(dump, run, [&](std::size_t, std::uint32_t pixel, const auto& explanation) {
    const explain::Attribution whence = explain::attribute(explanation);
    Colour sum(0, 0, 0);
    for (const explain::ExplainedPath& path : explanation.paths) {
      sum += triple_of(explanation.vertices.unfiltered[path.vertex]) /
             static_cast<double>(whence.pixel.paths);
    }
    for (const explain::SourceShare& source : whence.sources) sum += source.share;
    wrong += is_close(sum, colour_at(picture, "", pixel)) ? 0u : 1u;
  });
  CHECK(wrong == 0);
}

TEST_CASE("Refusals are those that the filter counts, alone ones what a term's absence lets in") {
  const TempFolder folder;
  write_dump(folder / "a.pvb", random_records(400, 5, 0.2, kOne), {kOne, {200, 200}, {}});
  const run::Dump dump(folder / "a.pvb");
  FilterRequest run = default_run("all");
  run.parameters.weights = terms_of(255);
  run.parameters.engine = filter::EngineKind::brute;
  run.parameters.count_refusals = true;
  const filter::Statistics all = run::filter_dump(dump, run).statistics;
  std::uint64_t candidates = 0;
  std::array<std::uint64_t, filter::kTermCount> refused{}, alone{};
  for_pixels(dump, run, [&](std::size_t, std::uint32_t, const auto& explanation) {
    const explain::Attribution whence = explain::attribute(explanation);
    candidates += whence.candidates;
    for (const explain::TermRefusals& of : whence.refusals) {
      refused[of.term] += of.refused;
      alone[of.term] += of.alone;
    }
  });
  CHECK(candidates == all.candidates);
  CHECK(refused == all.refused);
  for (unsigned k = 0; k < filter::kTermCount; ++k) {
    FilterRequest without = run;
    without.parameters.weights = terms_of(255u & ~(1u << k));
    INFO(filter::kTermNames[k]);
    CHECK(alone[k] == run::filter_dump(dump, without).statistics.accepted - all.accepted);
    CHECK((alone[k] > 0 || k == 0 || k == 5));  // these two go together in these records
  }
}

TEST_CASE("Paths that give no average are explained as such") {
  const TempFolder folder;
  RecordSet set = half_lit_floor();
  set.flags[7] = 0;                                                   // no vertex
  set.contribution[207].x = std::numeric_limits<float>::quiet_NaN();  // left out
  set.throughput[407] = Rgb(1e38f, 1e38f, 1e38f);                     // overflows
  set.contribution[407] = Rgb(1e38f, 1e38f, 1e38f);
  write_dump(folder / "a.pvb", set, {kOne, {200, 200, 200, 200}, {}});
  const run::Dump dump(folder / "a.pvb");
  FilterRequest run = default_run("all");
  run.parameters.radius = {0, filter::RadiusBasis::world, 0};
  const auto explanation = explain::explain(dump, request_of(run, 0, 7, 0));
  REQUIRE(explanation.paths.size() == 4);
  CHECK(explanation.paths[0].fate == explain::PathFate::no_vertex);
  CHECK(explanation.paths[1].fate == explain::PathFate::left_out);
  CHECK(explanation.paths[2].fate == explain::PathFate::overflowed);
  CHECK(explanation.paths[3].fate == explain::PathFate::averaged);
  const explain::Attribution whence = explain::attribute(explanation);
  CHECK(whence.pixel.paths == 2);
  CHECK(is_close(whence.pixel.filtered, colour_at(filtered(folder / "a.pvb", run).front(), "", 7)));

  explain::ExplainRequest one = request_of(run, 0, 0, 0);
  one.path = 7;
  const explain::Attribution bare = explain::attribute(explain::explain(dump, one));
  CHECK(bare.pixel.paths == 1);
  CHECK(bare.sources.empty());
}

TEST_CASE("One path by its number is what the filter makes of that path") {
  const TempFolder folder;
  const RecordSet set = random_records(800, 8, 0, kOne);
  write_dump(folder / "a.pvb", set, {kOne, {200, 200, 200, 200}, {}});
  const run::Dump dump(folder / "a.pvb");
  FilterRequest run = default_run("2passes");
  run.passes = {1, 4};
  // A pass of one path a pixel: its picture is that path.
  explain::ExplainRequest request = request_of(run, 0, 0, 0);
  request.path = 200 + 33;
  const auto explanation = explain::explain(dump, request);
  REQUIRE(explanation.paths.size() == 1);
  CHECK(explanation.record[explanation.paths[0].vertex] == 233);
  CHECK(explanation.pass[explanation.paths[0].vertex] == 1);
  const auto pixel = explain::explain(dump, request_of(run, 0, 13, 1));
  REQUIRE(pixel.paths.size() == 3);
  CHECK(pixel.paths[0].c_bar == explanation.paths[0].c_bar);
  CHECK(pixel.paths[0].neighbors == explanation.paths[0].neighbors);
}

TEST_CASE("What cannot be explained is an error of the right kind") {
  const TempFolder folder;
  RecordSet set = half_lit_floor();
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (set.pixel[i] == 199) set.pixel[i] = 198;
  }
  write_dump(folder / "a.pvb", set, {kOne, {200, 200, 200, 200}, {"visibility"}});
  const run::Dump dump(folder / "a.pvb");
  FilterRequest run = default_run("all");
  run.parameters.weights.visibility = false;
  const auto code_of = [&](const explain::ExplainRequest& request) {
    try {
      static_cast<void>(explain::explain(dump, request));
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::interrupted;  // none
  };
  CHECK(code_of(request_of(run, 0, 20, 0)) == ErrorCode::usage);
  FilterRequest hash = run;
  hash.parameters.estimator = filter::Estimator::hash;
  CHECK(code_of(request_of(hash, 0, 0, 0)) == ErrorCode::usage);
  FilterRequest fit = run;  // of what has no mean over a ball
  fit.parameters.estimator = filter::Estimator::disk;
  fit.parameters.fit = filter::BallFit::linear;
  CHECK(code_of(request_of(fit, 0, 0, 0)) == ErrorCode::usage);
  FilterRequest control = run;
  control.parameters.estimator = filter::Estimator::control;
  CHECK(code_of(request_of(control, 0, 0, 0)) == ErrorCode::usage);
  CHECK(code_of(request_of(run, 0, 0, 10)) == ErrorCode::usage);
  CHECK(code_of(request_of(run, 1, 0, 0)) == ErrorCode::usage);
  CHECK(code_of(request_of(run, 0, 19, 9)) == ErrorCode::bad_input);
  explain::ExplainRequest request = request_of(run, 0, 0, 0);
  request.path = 800;
  CHECK(code_of(request) == ErrorCode::usage);
  request = request_of(run, 0, 0, 0);
  request.passes = {3, 5};
  CHECK(code_of(request) == ErrorCode::usage);
  request = request_of(run, 0, 5, 5);
  request.most_pairs = 10;
  CHECK(code_of(request) == ErrorCode::limit);
  request.most_pairs = 100000;
  CHECK(code_of(request) == ErrorCode::interrupted);
  request.parameters.weights.visibility = true;
  CHECK(code_of(request) == ErrorCode::bad_input);
}

}  // namespace
}  // namespace psf
