// Alpha of a dump in its pictures: the mean of the channel, and the background apart.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "../filter/estimator_case.h"
#include "catch.h"
#include "core/error.h"
#include "core/parallel.h"
#include "film/light_layers.h"
#include "filter_dump_setup.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

// 600 records of two cameras, or of others; half of the paths without a vertex are of the background, and some
// others are covered in part.
class Covered {
 public:
  explicit Covered(std::uint32_t seed, double share_unshaded = 0,
                   const std::vector<filter::CameraView>& cameras = kTwo)
      : set_(random_records(600, seed, share_unshaded, cameras)), alpha_(set_.size(), 1.0f) {
    bool odd = false;
    for (std::size_t i = 0; i < set_.size(); ++i) {
      const bool vertex = (set_.flags[i] & filter::kHasVertex) != 0;
      if (!vertex) odd = !odd;
      if (!vertex && odd) alpha_[i] = 0;
      if (vertex && i % 7 == 0) alpha_[i] = 0.25f;
    }
    options_ = {cameras, {200, 200, 200}, {}};
    options_.alpha = &alpha_;
  }
  [[nodiscard]] std::string written() const {
    write_dump(folder_ / "a.pvb", set_, options_);
    return folder_ / "a.pvb";
  }
  [[nodiscard]] std::string without() const {
    DumpOptions options = options_;
    options.alpha = nullptr;
    write_dump(folder_ / "without.pvb", set_, options);
    return folder_ / "without.pvb";
  }
  RecordSet set_;
  std::vector<float> alpha_;
  DumpOptions options_;

 private:
  TempFolder folder_;
};

// The largest difference of colours from the sum of others, relative to what is added up.
double off_sum(const std::vector<Rgb>& all, const std::vector<std::vector<Rgb>>& parts) {
  double largest = 0;
  for (std::size_t pixel = 0; pixel < all.size(); ++pixel) {
    for (int c = 0; c < 3; ++c) {
      double sum = 0, size = 1e-20;
      for (const std::vector<Rgb>& part : parts) {
        sum += double{part[pixel][c]};
        size += std::abs(double{part[pixel][c]});
      }
      largest = std::max(largest, std::abs(sum - double{all[pixel][c]}) / size);
    }
  }
  return largest;
}

// Every picture of a dump with alpha is, with its background, that of the dump without.
void check_same_light(const Covered& dump, const FilterRequest& request) {
  const std::vector<film::Image> apart = filtered(dump.written(), request),
                                 whole = filtered(dump.without(), request);
  REQUIRE(apart.size() == whole.size());
  for (std::size_t camera = 0; camera < whole.size(); ++camera) {
    REQUIRE(apart[camera].has_background());
    REQUIRE_FALSE(whole[camera].has_background());
    for (const char* prefix : {"", "unfiltered-input."}) {
      const std::string p = prefix;
      CHECK(off_sum(whole[camera].rgb(p),
                    {apart[camera].rgb(p), apart[camera].rgb(p + "background.")}) <= 1e-6);
      CHECK(off_sum(whole[camera].rgb(p), {apart[camera].seen(p)}) <= 1e-6);
    }
    for (const film::Layer& layer : whole[camera].layers) {
      if (layer.channel.find_first_of("RGB") != std::string::npos &&
          layer.channel.find("albedo") == std::string::npos) {
        continue;
      }
      CHECK(*apart[camera].find(layer.channel) == layer.values);
    }
  }
}

TEST_CASE("Colours and background add up to the picture without alpha, for every estimator") {
  for (const filter::Estimator estimator : all_estimators()) {
    INFO(name_of(estimator));
    for (const char* r0 : {"0.25", "0"}) {
      FilterRequest request = default_run();
      request.parameters.estimator = estimator;
      filter::set_parameter(request.parameters, "r0", r0);
      check_same_light(Covered(61, 0, kOne), request);
    }
  }
}

TEST_CASE("They do where paths are not shaded or sources are few, in pixels without a path, too") {
  FilterRequest request = default_run();
  check_same_light(Covered(62, 0.6), request);
  filter::set_parameter(request.parameters, "sources", "1/4");
  check_same_light(Covered(63), request);
  filter::set_parameter(request.parameters, "iterations", "2");
  check_same_light(Covered(64), request);
}

TEST_CASE("A is the mean of the channel, and the background that of u where it is 0") {
  const Covered dump(65);
  const RecordSet& set = dump.set_;
  const std::vector<film::Image> pictures = filtered(dump.written(), default_run());
  for (std::size_t camera = 0; camera < kTwo.size(); ++camera) {
    const std::size_t pixels = std::size_t{kTwo[camera].width} * kTwo[camera].height;
    std::vector<double> alpha(pixels), count(pixels), red(pixels);
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (set.camera[i] != camera) continue;
      alpha[set.pixel[i]] += double{dump.alpha_[i]};
      count[set.pixel[i]] += 1;
      if (dump.alpha_[i] == 0) red[set.pixel[i]] += double{set.unfiltered[i].x};
    }
    const std::vector<float>&a = *pictures[camera].find("A"),
          &r = *pictures[camera].find("background.R");
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
      const double n = std::max(1.0, count[pixel]);
      CHECK(double{a[pixel]} == Approx(alpha[pixel] / n).margin(1e-7));
      CHECK(double{r[pixel]} == Approx(red[pixel] / n).margin(1e-7));
    }
  }
}

TEST_CASE("Layers of the light add up to the colours without the background") {
  Covered dump(66);
  std::vector<Rgb> key, rest, seen = dump.set_.unfiltered;
  for (const Rgb& c : dump.set_.contribution) {
    key.push_back(c * 0.25f);
    rest.push_back(c - key.back());
  }
  dump.options_.more = {
      {"contribution.key", &key}, {"contribution.rest", &rest}, {"unfiltered.rest", &seen}};
  for (const film::Image& image : filtered(dump.written(), default_run())) {
    for (const char* prefix : {"", "unfiltered-input."}) {
      const std::string p = prefix;
      CHECK(off_sum(image.rgb(p), {image.rgb(p + "key."), image.rgb(p + "rest.")}) <= 1e-6);
    }
  }
}

TEST_CASE("Without the layer alpha the pictures are those of a dump without it, bit for bit") {
  const Covered dump(67);
  FilterRequest request = default_run();
  const std::vector<film::Image> whole = filtered(dump.without(), request);
  request.layers.alpha = false;
  const std::vector<film::Image> off = filtered(dump.written(), request);
  CHECK(same(off, whole));
  CHECK(off[0].attributes == whole[0].attributes);
}

TEST_CASE("Pictures with alpha are the same for any number of threads") {
  const Covered dump(68);
  const std::vector<film::Image> all = filtered(dump.written(), default_run());
  const core::ThreadLimit one(1);
  CHECK(same(filtered(dump.written(), default_run()), all));
}

TEST_CASE("An alpha that is not finite counts as 1, is told, and takes no light away") {
  Covered dump(69);
  std::fill_n(dump.alpha_.begin(), 30, 1.0f);
  const std::vector<film::Image> good = filtered(dump.written(), default_run());
  for (std::size_t i = 0; i < 30; ++i) dump.alpha_[i] = i % 2 == 0 ? kNan : kInfinity;
  const run::FilterResult result = run::filter_dump(run::Dump(dump.written()), default_run());
  CHECK(result.not_finite_coverage == 30);
  CHECK(result.statistics.left_out == 0);
  CHECK(same(images(result.pictures), good));
}

TEST_CASE("The memory of alpha is in the estimate") {
  const Covered dump(72);
  const std::string path = dump.written();
  FilterRequest request = default_run();
  const run::MemoryEstimate all = run::filter_dump(run::Dump(path), request).memory;
  request.layers.alpha = false;
  const run::MemoryEstimate none = run::filter_dump(run::Dump(path), request).memory;
  CHECK(all.block == none.block + 200 * sizeof(float));
  CHECK(all.filter == none.filter);
  CHECK(all.pictures - none.pictures == 200 * (run::CameraPictures::kBytesOfSumsOfAlpha +
                                               run::CameraPictures::kBytesToWriteOfAlpha));
}

TEST_CASE("A layer of the light called background is refused beside alpha alone") {
  Covered dump(70);
  dump.options_.more = {{"unfiltered.background", &dump.set_.unfiltered}};
  try {
    (void)filtered(dump.written(), default_run());
    FAIL("two layers of one name");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::bad_input);
    CHECK(std::string(error.what()).find("psf cat --drop alpha") != std::string::npos);
  }
  CHECK(filtered(dump.without(), default_run())[0].find("background.R") != nullptr);
  FilterRequest request = default_run();
  request.layers.alpha = false;
  CHECK(filtered(dump.written(), request)[0].find("A") == nullptr);
}

TEST_CASE("An alpha of another type is refused by name") {
  Covered dump(71);
  dump.options_.alpha = nullptr;
  dump.options_.more = {{"alpha", &dump.set_.unfiltered}};
  CHECK_THROWS_AS(filtered(dump.written(), default_run()), Error);
}

}  // namespace
}  // namespace psf
