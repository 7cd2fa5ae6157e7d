// The second pass on the pictures of a dump: what it is told of the paths, and that parts of the
// light, sweeps and memory know of it.
#include "filter/pixels/second_pass.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "catch.h"
#include "core/parallel.h"
#include "filter_dump_setup.h"
#include "picture_difference.h"
#include "run/many_dump.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

// Six passes over one camera or two, whose pixels all have several paths.
class Passes {
 public:
  explicit Passes(std::uint32_t seed, const std::vector<filter::CameraView>& cameras = kOne)
      : set_(random_records(1200, seed, 0, cameras)), alpha_(set_.size(), 1.0f) {
    for (std::size_t i = 0; i < set_.size(); ++i) {
      key_.push_back(set_.contribution[i] * (i % 3 == 0 ? 0.25f : 1));
      rest_.push_back(set_.contribution[i] - key_.back());
      if ((set_.flags[i] & filter::kHasVertex) == 0 && i % 2 == 0) alpha_[i] = 0;
      if (i % 7 == 0) alpha_[i] = 0.25f;
    }
    options_ = {cameras, {200, 200, 200, 200, 200, 200}, {}};
  }
  [[nodiscard]] std::string written() const {
    write_dump(folder_ / "a.pvb", set_, options_);
    return folder_ / "a.pvb";
  }
  [[nodiscard]] std::string with_parts() {
    options_.alpha = &alpha_;
    options_.more = {{"contribution.key", &key_},
                     {"contribution.rest", &rest_},
                     {"unfiltered.rest", &set_.unfiltered}};
    return written();
  }
  [[nodiscard]] std::string with_alpha() {
    options_.alpha = &alpha_;
    return written();
  }
  RecordSet set_;
  std::vector<float> alpha_;

 private:
  std::vector<Rgb> key_, rest_;
  DumpOptions options_;
  TempFolder folder_;
};

FilterRequest regressed(const char* r0 = "0.25") {
  FilterRequest run = default_run("2passes");
  filter::set_parameter(run.parameters, "r0", r0);
  run.parameters.pixels = filter::PixelRule::regress;
  return run;
}

TEST_CASE("The second pass is told means and variances of each pixel's paths") {
  const Passes dump(81);
  const RecordSet& set = dump.set_;
  constexpr std::size_t kSize = 200;
  filter::PixelStatistics s;
  s.width = 20;
  s.height = 10;
  s.paths.resize(kSize);
  s.vertices.resize(kSize);
  for (auto* three : {&s.radiance, &s.variance, &s.reflectance, &s.normal, &s.position}) {
    three->resize(3 * kSize);
  }
  for (std::size_t pixel = 0; pixel < kSize; ++pixel) {
    std::vector<std::size_t> own, seen;
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (set.pixel[i] != pixel) continue;
      own.push_back(i);
      if ((set.flags[i] & filter::kHasVertex) != 0) seen.push_back(i);
    }
    const auto n = static_cast<double>(own.size()), v = static_cast<double>(seen.size());
    s.paths[pixel] = own.size();
    if (own.empty()) continue;
    s.vertices[pixel] = static_cast<float>(v / n);
    for (int c = 0; c < 3; ++c) {
      const std::size_t at = static_cast<std::size_t>(c) * kSize + pixel;
      const auto radiance = [&](std::size_t i) {
        const bool vertex = (set.flags[i] & filter::kHasVertex) != 0;
        return double{set.unfiltered[i][c] +
                      (vertex ? set.throughput[i][c] * set.contribution[i][c] : 0)};
      };
      double mean = 0, variance = 0, reflectance = 0, normal = 0, position = 0;
      for (const std::size_t i : own) mean += radiance(i) / n;
      for (const std::size_t i : own) variance += std::pow(radiance(i) - mean, 2);
      for (const std::size_t i : seen) {
        reflectance += double{set.reflectance[i][c]} / n;
        normal += double{set.normal[i][c]} / n;
        position += double{set.position[i][c]} / v;
      }
      s.radiance[at] = static_cast<float>(mean);
      s.variance[at] = own.size() < 2 ? 0 : static_cast<float>(variance / n / (n - 1));
      s.reflectance[at] = static_cast<float>(reflectance);
      s.normal[at] = static_cast<float>(normal);
      s.position[at] = static_cast<float>(position);
    }
  }
  std::vector<float> expected = s.radiance;
  std::vector<filter::PixelPlane> planes;
  for (std::size_t c = 0; c < 3; ++c) {
    planes.push_back({std::span(expected).subspan(c * kSize, kSize), c});
  }
  filter::second_pass(s, planes);

  // r0 = 0: every path keeps its contribution.
  const film::Image image = filtered(dump.written(), regressed("0"))[0];
  const char* names[] = {"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::vector<float>& got = *image.find(names[c]);
    double changed = 0;
    for (std::size_t pixel = 0; pixel < kSize; ++pixel) {
      CHECK(got[pixel] == Approx(expected[c * kSize + pixel]).margin(1e-4));
      changed += std::abs(double{got[pixel]} - double{s.radiance[c * kSize + pixel]});
    }
    CHECK(changed > 1);
  }
}

TEST_CASE("Colours, layers of the light and background add up after the second pass") {
  Passes dump(82, kTwo);
  const std::string path = dump.with_parts();
  FilterRequest run = regressed();
  const std::vector<film::Image> apart = filtered(path, run);
  run.layers.alpha = false;
  const std::vector<film::Image> whole = filtered(path, run);
  for (std::size_t camera = 0; camera < 2; ++camera) {
    const film::Image& image = apart[camera];
    REQUIRE(image.has_background());
    CHECK(largest_difference(image.seen(), whole[camera].rgb()) < 1e-4);
    std::vector<Rgb> sum = image.rgb("key."), rest = image.rgb("rest.");
    for (std::size_t pixel = 0; pixel < sum.size(); ++pixel) sum[pixel] += rest[pixel];
    CHECK(largest_difference(sum, image.rgb()) < 1e-4);
    for (const float alpha : *image.find("A")) CHECK((alpha >= 0 && alpha <= 1));
    run.layers.alpha = true;
    run.parameters.pixels = filter::PixelRule::keep;
    const film::Image kept = filtered(path, run)[camera];
    CHECK(*kept.find("A") != *image.find("A"));
    CHECK(*kept.find("neighbors.Y") == *image.find("neighbors.Y"));
    CHECK(kept.rgb("unfiltered-input.") == image.rgb("unfiltered-input."));
    run.layers.alpha = false;
    run.parameters.pixels = filter::PixelRule::regress;
  }
}

TEST_CASE(
    "Alpha stays in [0, 1] after the second pass, and fireflies go through it like all light") {
  Passes dump(86);
  for (std::size_t i = 0; i < dump.set_.size(); ++i) {
    const auto x = static_cast<float>(dump.set_.pixel[i] % 20),
               y = static_cast<float>(dump.set_.pixel[i] / 20);
    dump.set_.flags[i] = 3;
    dump.set_.position[i] = Vec3(0.01f * x, 0.01f * y, 0);
    dump.set_.contribution[i] = Rgb(1, 1, 1) * (i % 13 == 0 ? 200.0f : 1);
    dump.alpha_[i] = std::clamp((x - 5) / 4, 0.0f, 1.0f);
  }
  const std::string path = dump.with_alpha();
  FilterRequest run = regressed();
  run.parameters.fireflies.kind = filter::FireflyRule::Kind::spread;
  const film::Image image = filtered(path, run)[0];
  const std::vector<float>& alpha = *image.find("A");
  const auto [least, most] = std::minmax_element(alpha.begin(), alpha.end());
  CHECK(*least >= 0);
  CHECK(*most == 1);
  std::vector<float> fireflies = *image.find("fireflies.R");
  run.parameters.pixels = filter::PixelRule::keep;
  const film::Image kept = filtered(path, run)[0];
  CHECK(fireflies != *kept.find("fireflies.R"));
}

TEST_CASE("Many radii with a second pass are what separate runs give") {
  Passes dump(83, kTwo);
  dump.set_.contribution[77].x = std::numeric_limits<float>::infinity();
  dump.set_.throughput[300] = Rgb(3e38f, 1, 1);  // overflows, with some radii or all
  const run::Dump written(dump.written());
  run::ManyRequest many;
  many.parameters = regressed().parameters;
  for (const double r0 : {0.0, 0.1, 0.25}) {
    many.radii.push_back({r0, filter::RadiusBasis::distance, 0.25});
  }
  many.n = {3, 6};
  std::size_t seen = 0;
  many.on_pictures = [&](std::uint64_t n, const run::ManyResult& outcome) {
    for (std::size_t k = 0; k < many.radii.size(); ++k) {
      FilterRequest one = regressed();
      one.parameters.radius = many.radii[k];
      one.passes.last = n;
      const run::FilterResult expected = run::filter_dump(written, one);
      for (std::size_t camera = 0; camera < 2; ++camera, ++seen) {
        INFO("radius " << k << ", camera " << camera << ", " << n << " passes");
        const std::vector<Rgb> picture = expected.pictures[camera].image().rgb();
        CHECK(largest_difference(outcome.pictures[camera].filtered(k), picture) < 1e-3);
        one.parameters.pixels = filter::PixelRule::keep;
        CHECK(largest_difference(filtered(dump.written(), one)[camera].rgb(), picture) > 1e-2);
        one.parameters.pixels = filter::PixelRule::regress;
      }
    }
  };
  static_cast<void>(run::filter_many(written, many));
  CHECK(seen == 12);
}

TEST_CASE("The second pass is the same for any number of threads and with no layers at all") {
  const Passes dump(84, kTwo);
  FilterRequest run = regressed();
  const std::vector<film::Image> all = filtered(dump.written(), run);
  const core::ThreadLimit one(1);
  CHECK(same(filtered(dump.written(), run), all));
  run.layers = run::PictureLayers::none();
  CHECK(filtered(dump.written(), run)[1].rgb() == all[1].rgb());
}

TEST_CASE("The memory of the second pass is in the estimate") {
  const Passes dump(85);
  const std::string path = dump.written();
  FilterRequest request = regressed();
  const run::MemoryEstimate with = run::filter_dump(run::Dump(path), request).memory;
  request.parameters.pixels = filter::PixelRule::keep;
  const run::MemoryEstimate without = run::filter_dump(run::Dump(path), request).memory;
  CHECK(with.pictures - without.pictures == 200 * (run::CameraPictures::kBytesOfSumsOfRegress +
                                                   run::PixelFeatures::bytes_to_regress(3)));
}

}  // namespace
}  // namespace psf
