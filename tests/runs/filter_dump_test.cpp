// A whole dump through the filter: the pictures agree with the equations, block by block.
#include "run/filter_dump.h"

#include <cmath>
#include <limits>

#include "catch.h"
#include "core/parallel.h"
#include "filter_dump_setup.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

TEST_CASE("Pictures agree with the oracle for blocks of every kind, one camera and two") {
  const tests::TempFolder folder;
  for (const auto& cameras : {kOne, kTwo}) {
    const RecordSet set = tests::random_records(900, 1, 0.2, cameras);
    const std::string path = folder / (cameras.size() == 1 ? "one.pvb" : "two.pvb");
    tests::write_dump(path, set, {cameras, {200, 200, 200, 200, 100}, {}});
    const std::vector<std::pair<std::string, std::vector<std::size_t>>> partitions = {
        {"1pass", {0, 200, 400, 600, 800, 900}},
        {"2passes", {0, 400, 800, 900}},
        {"all", {0, 900}},
        {"2^8", {0, 256, 512, 768, 900}},
        {"7^3", {0, 343, 686, 900}},
        {"2^20", {0, 900}}};
    for (const auto& [block, bounds] : partitions) {
      for (const auto count : {filter::RadiusCount::samples, filter::RadiusCount::blocks}) {
        for (const bool fancy : {false, true}) {
          FilterRequest run = default_run(block);
          run.parameters.radius.count = count;
          if (fancy) {
            run.parameters.demodulate = true;
            run.parameters.iterations = 2;
            run.parameters.sources = 3;
            run.parameters.radius.basis = filter::RadiusBasis::footprint;
            run.parameters.radius.r0 = 3;
          }
          INFO(block << ", fancy " << fancy << ", " << cameras.size() << " cameras");
          const double pixels = 200;
          const auto n = [&](std::size_t k, std::size_t end) {
            return count == filter::RadiusCount::samples ? static_cast<double>(end) / pixels
                                                         : static_cast<double>(k + 1);
          };
          CHECK(
              by_oracle(set, run.parameters, cameras, bounds, n).differences(filtered(path, run)) ==
              0);
        }
      }
    }
  }
}

TEST_CASE("r0 = 0 gives the unfiltered picture bit for bit, demodulated too") {
  const tests::TempFolder folder;
  RecordSet set = tests::random_records(800, 2, 0, kTwo);
  set.contribution[5].x = std::numeric_limits<float>::quiet_NaN();
  tests::write_dump(folder / "a.pvb", set, {kTwo, {400, 400}, {}});
  FilterRequest run = default_run("all");
  run.parameters.radius = {0, filter::RadiusBasis::distance};
  for (const bool demodulate : {false, true}) {
    run.parameters.demodulate = demodulate;
    for (const film::Image& image : filtered(folder / "a.pvb", run)) {
      for (const char* channel : {"R", "G", "B"}) {
        REQUIRE(image.find(channel) != nullptr);
        CHECK(*image.find(channel) == *image.find(std::string("unfiltered-input.") + channel));
      }
    }
  }
}

TEST_CASE("What fireflies have spread is a layer of the picture") {
  const tests::TempFolder folder;
  RecordSet set(200);
  for (std::uint32_t i = 0; i < 200; ++i) set.pixel[i] = i;
  set.throughput.assign(200, Rgb(0.5f, 0.5f, 0.5f));
  set.flags[7] = 0;
  set.position[8] = Vec3(100, 0, 0);
  set.contribution[20] = Rgb(1e6f, 1e6f, 1e6f);
  tests::write_dump(folder / "a.pvb", set, {kOne, {200}, {}});
  FilterRequest run = default_run();
  CHECK(filtered(folder / "a.pvb", run)[0].find("fireflies.G") == nullptr);
  run.parameters.fireflies = {filter::FireflyRule::Kind::spread};
  const film::Image image = filtered(folder / "a.pvb", run)[0];
  const std::vector<float>& layer = *image.find("fireflies.G");
  CHECK(layer[0] == Approx(0.5 * 1e6 / 198));  // no other is as bright: to all within four radii
  CHECK(layer[20] == layer[0]);
  CHECK(layer[7] == 0);
  CHECK(layer[8] == 0);
  CHECK((*image.find("G"))[0] == Approx(0.5 * (197.0 / 198 + 1e6 / 198)));
  run.layers.fireflies = false;
  CHECK(filtered(folder / "a.pvb", run)[0].find("fireflies.G") == nullptr);
}

TEST_CASE("Layers hold neighbours, radius, albedo and normal") {
  const tests::TempFolder folder;
  RecordSet set(200);
  for (std::uint32_t i = 0; i < 200; ++i) set.pixel[i] = i;
  set.flags[7] = 0;
  set.position[8] = Vec3(100, 0, 0);
  tests::write_dump(folder / "a.pvb", set, {kOne, {200}, {}});
  const film::Image image = filtered(folder / "a.pvb", default_run())[0];
  CHECK((*image.find("neighbors.Y"))[0] == 198);
  CHECK((*image.find("neighbors.Y"))[7] == 0);
  CHECK((*image.find("neighbors.Y"))[8] == 1);
  CHECK((*image.find("radius.Y"))[0] == 0.25f);
  CHECK((*image.find("albedo.G"))[0] == 0.5f);
  CHECK((*image.find("normal.Y"))[0] == 1);
  CHECK((*image.find("normal.Y"))[7] == 0);
  tests::write_dump(folder / "b.pvb", set, {kOne, {200}, {"normal", "reflectance"}});
  FilterRequest run = default_run();
  run.parameters.weights = filter::WeightTerms::none();
  CHECK(filtered(folder / "b.pvb", run)[0].find("albedo.R") == nullptr);
}

TEST_CASE("The same pictures for any number of threads") {
  const tests::TempFolder folder;
  const RecordSet set = tests::random_records(2000, 3, 0.3, kTwo);
  tests::write_dump(folder / "a.pvb", set, {kTwo, {1000, 1000}, {}});
  const auto with_threads = [&](std::size_t threads) {
    const core::ThreadLimit limit(threads);
    return filtered(folder / "a.pvb", default_run("2^9"));
  };
  const auto one = with_threads(1);
  CHECK(same(one, with_threads(2)));
  CHECK(same(one, with_threads(4)));
}

TEST_CASE("Non-finite records are no part of any picture and spread nowhere") {
  const tests::TempFolder folder;
  RecordSet set = tests::random_records(400, 7, 0, kOne);
  RecordSet without = set;
  for (const std::size_t i : {20u, 21u, 300u}) {
    set.flags[i] = 3;
    set.contribution[i].y = static_cast<float>(NAN);
    set.reflectance[i].x = static_cast<float>(NAN);
    set.normal[i].z = static_cast<float>(INFINITY);
    without.flags[i] = filter::kHasVertex;  // a source no more
  }
  tests::write_dump(folder / "a.pvb", set, {kOne, {200, 200}, {}});
  tests::write_dump(folder / "b.pvb", without, {kOne, {200, 200}, {}});
  const run::FilterResult outcome = run::filter_dump(run::Dump(folder / "a.pvb"), default_run());
  CHECK(outcome.statistics.left_out == 3);
  CHECK(outcome.statistics.records == 400);
  const film::Image got = outcome.pictures[0].image();
  const film::Image other = filtered(folder / "b.pvb", default_run())[0];
  for (const film::Layer& layer : got.layers) {
    for (std::size_t pixel = 0; pixel < layer.values.size(); ++pixel) {
      REQUIRE(std::isfinite(layer.values[pixel]));
      const bool own = pixel == 20 || pixel == 21 || pixel == 100;
      if (!own && layer.channel.size() == 1)
        CHECK(layer.values[pixel] == (*other.find(layer.channel))[pixel]);
    }
  }
}

TEST_CASE("A product that overflows is left out and counted") {
  const tests::TempFolder folder;
  RecordSet set(200);
  for (std::uint32_t i = 0; i < 200; ++i) {
    set.pixel[i] = i;
    set.position[i].x = static_cast<float>(i);
  }
  set.contribution[9] = Rgb(1e30f);
  set.throughput[9] = Rgb(1e30f);
  tests::write_dump(folder / "a.pvb", set, {kOne, {200}, {}});
  const run::FilterResult outcome = run::filter_dump(run::Dump(folder / "a.pvb"), default_run());
  CHECK(outcome.overflows == 1);
  CHECK((*outcome.pictures[0].image().find("R"))[9] == 0);
  CHECK((*outcome.pictures[0].image().find("R"))[8] == 1);
}

}  // namespace
}  // namespace psf
