// Non-finite input is counted by channel, left out, and never spreads.
#include <algorithm>
#include <functional>

#include "catch.h"
#include "estimator_case.h"
#include "filter/estimate.h"

namespace psf {
namespace {

using filter::Parameters;
using tests::EstimatorRun;
using tests::RecordSet;

struct Damage {
  const char* channel;
  std::function<void(RecordSet&, std::size_t, float)> apply;
  bool infinity_is_bad = true;
};

const std::vector<Damage>& damages() {
  static const std::vector<Damage> all = {
      {"unfiltered", [](RecordSet& s, std::size_t i, float v) { s.unfiltered[i].y = v; }},
      {"throughput", [](RecordSet& s, std::size_t i, float v) { s.throughput[i].z = v; }},
      {"position", [](RecordSet& s, std::size_t i, float v) { s.position[i].x = v; }},
      {"distance", [](RecordSet& s, std::size_t i, float v) { s.distance[i] = v; }},
      {"contribution", [](RecordSet& s, std::size_t i, float v) { s.contribution[i].x = v; }},
      {"normal", [](RecordSet& s, std::size_t i, float v) { s.normal[i].y = v; }},
      {"reflectance", [](RecordSet& s, std::size_t i, float v) { s.reflectance[i].z = v; }},
      {"hit_distance", [](RecordSet& s, std::size_t i, float v) { s.hit_distance[i] = v; }, false},
      {"direction", [](RecordSet& s, std::size_t i, float v) { s.direction[i].x = v; }},
      {"roughness", [](RecordSet& s, std::size_t i, float v) { s.roughness[i] = v; }}};
  return all;
}

Parameters all_terms() {
  Parameters parameters;
  parameters.radius = {0.3, filter::RadiusBasis::distance};
  parameters.weights = {0.5f, 0.2f, false, 0.9f, 0.9f, 0.1f, false, 1.0f};
  return parameters;
}

std::size_t count_of(const filter::Statistics& statistics, const std::string& channel) {
  for (std::size_t k = 0; k < filter::kCheckedChannels; ++k) {
    if (channel == filter::kCheckedNames[k]) return statistics.non_finite[k];
  }
  return 999;
}

TEST_CASE("A bad value takes its record out and changes no other") {
  const RecordSet clean = tests::random_records(600, 1, 0, tests::kCamera);
  std::size_t victim = 100;
  while (clean.flags[victim] != 3) ++victim;
  RecordSet without = clean;
  without.flags[victim] = 0;
  const filter::Estimates expected = EstimatorRun(all_terms())(without);
  for (const Damage& damage : damages()) {
    for (const float bad : {tests::kNan, tests::kInfinity, -tests::kInfinity}) {
      if (bad == tests::kInfinity && !damage.infinity_is_bad) continue;
      INFO(damage.channel << " = " << bad);
      RecordSet set = clean;
      damage.apply(set, victim, bad);
      const filter::Estimates result = EstimatorRun(all_terms())(set);
      CHECK(result.roles[victim] == filter::Role::left_out);
      CHECK(result.statistics.left_out == 1);
      CHECK(count_of(result.statistics, damage.channel) == 1);
      CHECK(result.c_bar == expected.c_bar);
      CHECK(result.neighbors == expected.neighbors);
    }
  }
}

TEST_CASE("A miss is no bad value") {
  RecordSet set(10);
  set.hit_distance.assign(10, tests::kInfinity);
  const filter::Estimates result = EstimatorRun(all_terms())(set);
  CHECK(result.statistics.left_out == 0);
  CHECK(result.neighbors[0] == 10);
}

TEST_CASE(
    "Where hit distances are compared, what lacks them is left out with its share of the sky") {
  // Half of 80 paths meet the sky; one in four of either half is shaded.
  RecordSet set(80);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const bool vertex = i % 2 == 0, shaded = i / 2 % 4 == 0;
    set.flags[i] = static_cast<std::uint8_t>((vertex ? filter::kHasVertex : 0) |
                                             (shaded ? filter::kShaded : 0));
    if (!shaded) set.hit_distance[i] = tests::kNan;
  }
  Parameters parameters = all_terms();
  filter::Block block{0, 1, 1, tests::kCamera};
  block.shade_rate = 4;
  const auto roles_of = [&] {
    filter::Statistics statistics;
    const filter::Roles roles = filter::find_roles(set.view(), block, parameters, statistics);
    CHECK(statistics.left_out == count_of(statistics, "hit_distance"));
    return roles.of;
  };
  const auto count = [](const std::vector<filter::Role>& roles, filter::Role role) {
    return std::count(roles.begin(), roles.end(), role);
  };
  std::vector<filter::Role> roles = roles_of();
  CHECK(count(roles, filter::Role::left_out) == 60);
  CHECK(count(roles, filter::Role::source) == 10);
  CHECK(count(roles, filter::Role::no_vertex) == 10);

  parameters.weights.hit_distance.reset();
  CHECK(count(roles_of(), filter::Role::left_out) == 0);

  // With the distances all paths are of use.
  set.hit_distance.assign(80, 1);
  parameters = all_terms();
  CHECK(count(roles_of(), filter::Role::left_out) == 0);
}

TEST_CASE("What nothing uses may be anything") {
  RecordSet set(10);
  set.normal[3].x = tests::kNan;
  set.reflectance[3].x = tests::kNan;
  set.hit_distance[3] = tests::kNan;
  set.direction[3].x = tests::kNan;
  set.roughness[3] = tests::kNan;
  set.distance[3] = tests::kNan;
  Parameters parameters;
  parameters.radius.basis = filter::RadiusBasis::world;
  parameters.weights = filter::WeightTerms::none();
  CHECK(EstimatorRun(parameters)(set).statistics.left_out == 0);
  // A path without vertex has only its own radiance.
  set.flags[3] = 0;
  set.position[3].x = set.contribution[3].x = set.throughput[3].x = tests::kNan;
  CHECK(EstimatorRun(all_terms())(set).statistics.left_out == 0);
  set.unfiltered[3].x = tests::kNan;
  CHECK(EstimatorRun(all_terms())(set).statistics.left_out == 1);
  // An unshaded one has no contribution.
  set.unfiltered[4].x = 0;
  set.flags[4] = filter::kHasVertex;
  set.contribution[4].x = tests::kNan;
  CHECK(EstimatorRun(all_terms())(set).statistics.left_out == 1);
}

TEST_CASE("A quotient that overflows counts for the reflectance") {
  RecordSet set(10);
  set.contribution[2] = Rgb(1e10f);
  set.reflectance[2].y = 1e-35f;
  Parameters parameters;
  parameters.demodulate = true;
  const filter::Estimates result = EstimatorRun(parameters)(set);
  CHECK(result.statistics.left_out == 1);
  CHECK(count_of(result.statistics, "reflectance") == 1);
  CHECK(is_finite(result.c_bar[0]));
}

TEST_CASE("A record may be bad in several channels and is left out once") {
  RecordSet set(10);
  set.position[1].y = tests::kInfinity;
  set.contribution[1].y = tests::kNan;
  const filter::Statistics statistics = EstimatorRun(filter::Parameters())(set).statistics;
  CHECK(statistics.left_out == 1);
  CHECK(count_of(statistics, "position") == 1);
  CHECK(count_of(statistics, "contribution") == 1);
  CHECK(statistics.queries == 9);
}

TEST_CASE("With every record bad there is nothing, and no failure") {
  RecordSet set(10);
  for (Vec3& p : set.position) p.x = tests::kNan;
  const filter::Estimates result = EstimatorRun(filter::Parameters())(set);
  CHECK(result.statistics.left_out == 10);
  CHECK(result.statistics.queries == 0);
}

}  // namespace
}  // namespace psf
