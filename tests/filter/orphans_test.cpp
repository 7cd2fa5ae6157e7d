// Queries without a source in their ball get the nearest that pass, never nothing.
#include "catch.h"
#include "filter/estimate.h"
#include "record_set.h"

namespace psf {
namespace {

const std::vector<filter::CameraView> kOrphansCamera = {{64, 64, 0.05}};

filter::Estimates run_at(const tests::RecordSet& set, float r,
                         const filter::Parameters& parameters) {
  return filter::estimate(set.view(), std::vector<float>(set.size(), r), {0, 1, 1, kOrphansCamera},
                          parameters);
}

// Record 0 is unshaded at the origin, the others are sources at x = 1, 2, 3 ... with c = 10, 20, 30
// ...
tests::RecordSet line(std::size_t sources) {
  tests::RecordSet set(sources + 1);
  set.flags[0] = filter::kHasVertex;
  for (std::size_t k = 1; k <= sources; ++k) {
    set.position[k].x = static_cast<float>(k);
    set.contribution[k] = Rgb(10 * static_cast<float>(k));
  }
  return set;
}

TEST_CASE("An orphan takes its four nearest sources") {
  const filter::Estimates result = run_at(line(9), 0.5f, {});
  CHECK(result.c_bar[0] == Rgb(25));
  CHECK(result.neighbors[0] == 0);
  CHECK(result.roles[0] == filter::Role::query);
  CHECK(result.statistics.orphans == 1);
  CHECK(result.statistics.orphans_unmatched == 0);
}

TEST_CASE("An orphan takes fewer where there are fewer, and only those that pass") {
  CHECK(run_at(line(2), 0.5f, {}).c_bar[0] == Rgb(15));
  tests::RecordSet set = line(9);
  for (const std::size_t k : {1u, 2u, 4u, 5u, 6u, 9u}) set.normal[k] = Vec3(1, 0, 0);
  CHECK(run_at(set, 0.5f, {}).c_bar[0] == Rgb(60));  // 3, 7, 8
}

TEST_CASE("An orphan's ties go to the lower record") {
  tests::RecordSet set(8);
  set.flags[0] = filter::kHasVertex;
  for (std::size_t k = 1; k < 8; ++k) {
    set.position[k] = Vec3(k % 2 == 0 ? 1.0f : -1.0f, 0, 0);
    set.contribution[k] = Rgb(static_cast<float>(k));
  }
  CHECK(run_at(set, 0.5f, {}).c_bar[0] == Rgb(2.5f));  // 1, 2, 3, 4
}

TEST_CASE("The search for an orphan's source ends at the last one") {
  for (const std::size_t sources : {15u, 16u, 17u, 100u, 3000u}) {
    tests::RecordSet set = line(sources);
    for (std::size_t k = 1; k < sources; ++k) set.material[k] = 1;
    filter::Parameters parameters;
    parameters.weights.material = true;
    const filter::Estimates result = run_at(set, 0.5f, parameters);
    CHECK(result.c_bar[0] == Rgb(10 * static_cast<float>(sources)));
    CHECK(result.statistics.orphans_unmatched == 0);
    set.material[sources] = 1;
    const filter::Estimates unmatched = run_at(set, 0.5f, parameters);
    CHECK(unmatched.c_bar[0] == Rgb(10));
    CHECK(unmatched.statistics.orphans == 1);
    CHECK(unmatched.statistics.orphans_unmatched == 1);
  }
}

TEST_CASE("Without any source in the block its queries are left out and counted") {
  tests::RecordSet set = line(3);
  for (auto& flags : set.flags) flags = filter::kHasVertex;
  set.flags[2] = 0;
  const filter::Estimates result = run_at(set, 9, {});
  CHECK(result.statistics.without_source == 3);
  CHECK(result.roles[0] == filter::Role::left_out);
  // Where no path with a vertex is shaded, none without one is part of the picture without filter.
  CHECK(result.roles[2] == filter::Role::unchosen);
}

TEST_CASE(
    "A K-th of the sources stays with --sources 1/K, spread over the picture and over the passes") {
  tests::RecordSet set(64 * 64);
  for (std::uint32_t i = 0; i < set.size(); ++i) set.pixel[i] = i;
  for (const std::uint32_t k : {2u, 3u, 4u, 16u}) {
    filter::Parameters parameters;
    parameters.sources = k;
    std::vector<std::size_t> times(set.size());
    for (std::uint64_t pass = 0; pass < k * 8; ++pass) {
      const filter::Block block{pass * set.size(), 1, 1, kOrphansCamera};
      filter::Statistics statistics;
      const filter::Roles roles = filter::find_roles(set.view(), block, parameters, statistics);
      CHECK(static_cast<double>(statistics.sources) * k == Approx(64 * 64).epsilon(0.02));
      std::vector<std::size_t> in_tile(64);  // 8 x 8 pixels
      for (const std::uint32_t i : roles.sources) {
        ++times[i];
        ++in_tile[i / 64 / 8 * 8 + i % 64 / 8];
      }
      const auto [fewest, most] = std::minmax_element(in_tile.begin(), in_tile.end());
      CHECK(*fewest >= 64 / k - 3);
      CHECK(*most <= 64 / k + 4);
    }
    const auto [fewest, most] = std::minmax_element(times.begin(), times.end());
    CHECK(*fewest >= 6);
    CHECK(*most <= 10);
  }
}

}  // namespace
}  // namespace psf
