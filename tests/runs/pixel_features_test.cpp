// What the second pass is told of paths that are few, odd, or in the pictures of some radii alone.
#include "run/pixel_features.h"

#include <limits>
#include <vector>

#include "../filter/record_set.h"
#include "catch.h"
#include "run/many_pictures.h"

namespace psf {
namespace {

using filter::Role;
using run::ManyPictures;
using run::PixelFeatures;

const std::vector<filter::CameraView> kSmall = {{12, 9, 0.05}};
constexpr std::size_t kSmallSize = 108;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

TEST_CASE("Features are means over paths, of places over vertices, without what is not finite") {
  tests::RecordSet set = tests::random_records(4, 1, 0, kSmall);
  for (std::size_t i = 0; i < 4; ++i) {
    set.pixel[i] = 7;
    set.reflectance[i] = Rgb(0.5f, 0.25f, 1);
    set.normal[i] = Vec3(0, 0, 1);
    set.position[i] = Vec3(static_cast<float>(i), 2, 3);
  }
  set.reflectance[1].y = kNaN;
  set.normal[0].z = tests::kInfinity;
  PixelFeatures features(kSmall[0]);
  const Role roles[] = {Role::source, Role::query, Role::no_vertex, Role::source};
  for (std::size_t i = 0; i < 4; ++i) features.add(set.view(), roles[i], i);
  const filter::PixelStatistics s = features.statistics();
  CHECK(s.paths[7] == 4);
  CHECK(s.vertices[7] == 0.75f);
  CHECK(s.reflectance[7] == 0.25f);
  CHECK(s.reflectance[kSmallSize + 7] == 0.125f);
  CHECK(s.normal[2 * kSmallSize + 7] == 0.5f);
  CHECK(s.position[7] == Approx(4 / 3.0));
  CHECK(s.position[2 * kSmallSize + 7] == 3);
  CHECK(s.paths[8] == 0);
}

TEST_CASE("Two paths have a variance, one has none, and none is below 0") {
  filter::PixelStatistics s = PixelFeatures(kSmall[0]).statistics();
  const double two[] = {4, 0, 0.2}, squares[] = {10, 0, 0.02 - 1e-18};
  PixelFeatures::set_radiance(s, 5, 2, two, squares);
  CHECK(s.radiance[5] == 2);
  CHECK(s.variance[5] == 1);  // of 1 and 3: ((1 - 2)^2 + (3 - 2)^2) / 1 / 2
  CHECK(s.variance[2 * kSmallSize + 5] == 0);
  PixelFeatures::set_radiance(s, 6, 1, two, squares);
  CHECK(s.radiance[6] == 4);
  CHECK(s.variance[6] == 0);
}

// Four passes of light that the second pass changes, for radii [first, 11), but for those left out.
template <class Overflows>
ManyPictures pictures(std::size_t first, const Overflows& overflows) {
  tests::RecordSet set = tests::random_records(4 * kSmallSize, 3, 0, kSmall);
  ManyPictures result(kSmall[0], 11, filter::PixelRule::regress);
  for (std::size_t i = 0; i < set.size(); ++i) {
    set.throughput[i] = Rgb(1, 1, 1);
    set.unfiltered[i] = Rgb(0.5f, 0.5f, 0.5f);
    // Features of a pixel are those of each of its paths.
    set.position[i] = set.position[set.pixel[i]];
    set.normal[i] = set.normal[set.pixel[i]];
    set.reflectance[i] = set.reflectance[set.pixel[i]];
  }
  for (std::size_t i = 0; i < set.size(); ++i) {
    std::vector<Rgb> c_bar;
    for (std::size_t k = first; k < 11; ++k) {
      c_bar.push_back(set.contribution[i] * (1 + 0.1f * static_cast<float>(k)));
    }
    const bool whole = overflows(set, i, first, c_bar);
    if (!whole) continue;
    result.add_record(set.view(), Role::source, i);
    result.add_filtered(set.view(), i, first, c_bar,
                        [&](std::size_t radius) { result.leave_out(set.view(), i, radius); });
  }
  return result;
}

void check_same(const std::vector<Rgb>& got, const std::vector<Rgb>& expected) {
  for (std::size_t pixel = 0; pixel < kSmallSize; ++pixel) {
    INFO("pixel " << pixel);
    for (int c = 0; c < 3; ++c) CHECK(got[pixel][c] == Approx(expected[pixel][c]).margin(1e-5));
  }
}

TEST_CASE("A picture of many radii is that of its radius alone") {
  const tests::RecordSet set = tests::random_records(4 * kSmallSize, 3, 0, kSmall);
  ManyPictures many(kSmall[0], 11, filter::PixelRule::regress),
      alone(kSmall[0], 1, filter::PixelRule::regress);
  const auto never = [](std::size_t) { FAIL("nothing overflows"); };
  for (std::size_t i = 0; i < set.size(); ++i) {
    const Role role = set.flags[i] == 3 ? Role::source : Role::no_vertex;
    many.add_record(set.view(), role, i);
    alone.add_record(set.view(), role, i);
    if (role != Role::source) continue;
    std::vector<Rgb> c_bar;
    for (std::size_t k = 0; k < 11; ++k) {
      c_bar.push_back(set.contribution[(i * (k + 1)) % set.size()]);
    }
    many.add_filtered(set.view(), i, 0, c_bar, never);
    alone.add_filtered(set.view(), i, 0, {&c_bar[9], 1}, never);
  }
  CHECK(many.filtered(9) == alone.filtered(0));
}

TEST_CASE("Squares of paths that overflow in one radius of a group are left out of that alone") {
  constexpr std::size_t kFirst = 3;  // radii 0, 1 and 2 of the group are added by nobody
  const auto none = [](const auto&, std::size_t, std::size_t, const auto&) { return true; };
  const auto one = [](const auto&, std::size_t i, std::size_t first, std::vector<Rgb>& c_bar) {
    if (i % 7 == 4) c_bar[6 - first].x = tests::kInfinity;
    return true;
  };
  // The same paths are in no picture.
  const auto dropped = [](const auto&, std::size_t i, std::size_t, const auto&) {
    return i % 7 != 4;
  };
  const ManyPictures all = pictures(kFirst, none), some = pictures(kFirst, one),
                     without = pictures(kFirst, dropped);
  for (const std::size_t k : {3u, 4u, 5u, 7u, 8u, 10u}) {
    INFO("radius " << k);
    CHECK(all.filtered(k) == some.filtered(k));
  }
  CHECK(all.filtered(6) != some.filtered(6));
  check_same(some.filtered(6), without.filtered(6));
}

TEST_CASE("A pixel whose paths all overflow in a radius is as if it had none") {
  const auto one = [](const auto& set, std::size_t i, std::size_t first, std::vector<Rgb>& c_bar) {
    if (set.pixel[i] == 40) c_bar[9 - first].y = tests::kInfinity;
    return true;
  };
  const auto dropped = [](const auto& set, std::size_t i, std::size_t, const auto&) {
    return set.pixel[i] != 40;
  };
  const std::vector<Rgb> got = pictures(0, one).filtered(9),
                         expected = pictures(0, dropped).filtered(9);
  check_same(got, expected);
}

}  // namespace
}  // namespace psf
