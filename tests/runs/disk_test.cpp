// The disk estimator, photon mapping's, on a scene with a known answer.
#include <cmath>
#include <random>

#include "catch.h"
#include "core/error.h"
#include "filter_dump_setup.h"
#include "run/filter_dump.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

TEST_CASE("The disk estimator refuses several cameras") {
  const tests::TempFolder folder;
  const RecordSet set = tests::random_records(400, 9, 0, kTwo);
  tests::write_dump(folder / "two.pvb", set, {kTwo, {400}, {}});
  FilterRequest run = default_run();
  run.parameters.estimator = filter::Estimator::disk;
  CHECK_THROWS_AS(filtered(folder / "two.pvb", run), Error);
}

// A tilted plane that reflects 1, seen by a pinhole at the origin looking along -z, two samples a
// pixel a pass.
TEST_CASE("On a plane the disk estimator gives the radiance that is there, whatever the samples") {
  const tests::TempFolder folder;
  constexpr std::uint32_t kSide = 48;
  const double angle = 0.002;
  const std::vector<filter::CameraView> camera = {{kSide, kSide, angle}};
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  for (const float tilt : {0.0f, 1.0f}) {
    RecordSet set(2 * 2 * kSide * kSide);
    const Vec3 normal(0, std::sin(tilt), std::cos(tilt));
    for (std::uint32_t i = 0; i < set.size(); ++i) {
      set.pixel[i] = i % (kSide * kSide);
      const float x = static_cast<float>(angle) *
                      (static_cast<float>(set.pixel[i] % kSide) + unit(random) - kSide / 2);
      const float y = static_cast<float>(angle) *
                      (static_cast<float>(set.pixel[i] / kSide) + unit(random) - kSide / 2);
      const Vec3 ray = Vec3(x, -y, -1).normalized();
      // The plane passes through (0, 0, -10).
      set.distance[i] = -10 * normal.z / dot(ray, normal);
      set.position[i] = ray * set.distance[i];
      set.direction[i] = -ray;
      set.normal[i] = normal;
    }
    for (const auto& passes : {std::vector<std::size_t>{2 * kSide * kSide, 2 * kSide * kSide},
                               std::vector<std::size_t>{4 * kSide * kSide}}) {
      tests::write_dump(folder / "a.pvb", set, {camera, passes, {}});
      FilterRequest run = default_run();
      run.parameters.radius = {0.015, filter::RadiusBasis::distance, 0, {}};
      run.parameters.estimator = filter::Estimator::disk;
      const film::Image image = filtered(folder / "a.pvb", run)[0];
      double sum = 0, count = 0;
      for (std::uint32_t y = 14; y < kSide - 14; ++y) {
        for (std::uint32_t x = 14; x < kSide - 14; ++x, ++count)
          sum += double{(*image.find("R"))[y * kSide + x]};
      }
      INFO("tilt " << tilt << ", " << passes.size() << " passes");
      CHECK(sum / count == Approx(1).epsilon(0.01));
    }
  }
}

}  // namespace
}  // namespace psf
