// Windows of frames, block by block: what holds of one frame holds of several.
#include "filter/window.h"

#include <cmath>
#include <vector>

#include "catch.h"
#include "record_set.h"

namespace psf {
namespace {

using filter::Estimates;
using filter::FrameWindow;

const std::vector<filter::CameraView> kCamera = {{20, 10, 0.05}};

filter::Block block_of(std::uint64_t first_path) {
  return {first_path, 1, 1, kCamera};
}

// Two frames of the same records, the second taken in by the first.
Estimates with_itself(const filter::Records& records, const filter::Parameters& parameters,
                      const filter::WindowTerms& terms) {
  const std::vector<float> radius(records.size(), 0.3f);
  const filter::Block own = block_of(0), other = block_of(200);
  FrameWindow window(records, radius, own, parameters, terms);
  window.add(records, other);
  return window.finish();
}

TEST_CASE("A window over a frame and its copy has every neighbour twice, and the same averages") {
  const tests::RecordSet set = tests::random_records(200, 3, 0.2, kCamera);
  filter::Parameters parameters;
  const std::vector<float> radius(set.size(), 0.3f);
  const Estimates alone = filter::estimate(set.view(), radius, block_of(0), parameters);
  filter::WindowTerms terms;
  terms.relit.reset();
  const Estimates both = with_itself(set.view(), parameters, terms);
  std::size_t several = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    CHECK(both.roles[i] == alone.roles[i]);
    if (!filter::is_query(alone.roles[i])) continue;
    // A source that no weight lets pass to itself counts once.
    CHECK(both.neighbors[i] <= 2 * alone.neighbors[i]);
    several += both.neighbors[i] == 2 * alone.neighbors[i] && alone.neighbors[i] > 1 ? 1u : 0u;
    if (both.neighbors[i] != 2 * alone.neighbors[i]) continue;
    for (int k = 0; k < 3; ++k) {
      CHECK(std::abs(both.c_bar[i][k] - alone.c_bar[i][k]) <= 1e-6f * (1 + alone.c_bar[i][k]));
    }
  }
  CHECK(several > 40);
  CHECK(both.statistics.orphans == alone.statistics.orphans);
}

TEST_CASE("Constant light stays as it is in a window, demodulated by what is lit too") {
  tests::RecordSet set = tests::random_records(200, 4, 0, kCamera);
  for (const bool demodulate : {false, true}) {
    for (std::size_t i = 0; i < set.size(); ++i) {
      const float rho = 0.2f + 0.1f * static_cast<float>(i % 5);
      set.reflectance[i] = Rgb(rho, 0.5f, 0.9f - rho);
      set.contribution[i] = demodulate ? set.reflectance[i] * 0.7f : Rgb(0.7f, 0.7f, 0.7f);
    }
    filter::Parameters parameters;
    parameters.demodulate = demodulate;
    parameters.weights.reflectance.reset();
    const Estimates both = with_itself(set.view(), parameters, {});
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (!filter::is_query(both.roles[i])) continue;
      for (int k = 0; k < 3; ++k) {
        const float c = set.contribution[i][k];
        CHECK(std::abs(both.c_bar[i][k] - c) <= (demodulate ? 1e-6f : 0));
      }
    }
  }
}

TEST_CASE("In a window volumes take in volumes, and surfaces surfaces") {
  tests::RecordSet set(200);
  std::vector<std::uint8_t> kind(200, 0);
  for (std::size_t i = 0; i < set.size(); ++i) {
    set.pixel[i] = static_cast<std::uint32_t>(i);
    set.position[i] = Vec3(0.01f * static_cast<float>(i / 2), 0, 0);
    if (i % 2 == 0) continue;
    kind[i] = filter::kVolume;
    set.contribution[i] = Rgb(3, 3, 3);
  }
  filter::Records records = set.view();
  records.kind = kind;
  filter::WindowTerms terms;
  terms.relit.reset();
  const Estimates both = with_itself(records, {}, terms);
  for (std::size_t i = 0; i < set.size(); ++i) {
    CHECK(both.c_bar[i].x == (i % 2 == 0 ? 1.0f : 3.0f));
    CHECK(both.neighbors[i] > 30);
    CHECK(both.neighbors[i] % 2 == 0);
  }
}

TEST_CASE("A place at rest that is not finite is found by no other frame") {
  tests::RecordSet set(200);
  std::vector<Vec3> rest(200, Vec3(0, 0, 0));
  for (std::size_t i = 0; i < set.size(); ++i) set.pixel[i] = static_cast<std::uint32_t>(i);
  rest[7].y = tests::kNan;
  filter::Records records = set.view();
  records.rest_position = rest;
  const Estimates both = with_itself(records, {}, {std::nullopt, true});
  for (std::size_t i = 0; i < set.size(); ++i) {
    CHECK(both.neighbors[i] == (i == 7 ? 200u : 399u));
    CHECK(both.c_bar[i].x == 1);
  }
}

}  // namespace
}  // namespace psf
