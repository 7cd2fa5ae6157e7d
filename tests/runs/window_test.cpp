// Windows of frames, from dumps to pictures: against loops over all pairs, what moves and what is
// relit.
#include "run/window.h"

#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "catch.h"
#include "core/error.h"
#include "core/parallel.h"
#include "filter_dump_setup.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

// Frames of one pass each, 200 pixels, with places at rest beside the others.
struct Frames {
  explicit Frames(RecordSet records) : set(std::move(records)) {
    for (const Vec3& x : set.position) rest.emplace_back(x.x, x.y, x.z);
  }
  void write(const std::string& path) const {
    DumpOptions options;
    options.cameras = kOne;
    options.passes.assign(set.size() / 200, 200);
    options.more = {{"rest_position", &rest},
                    {"contribution.one", &set.contribution},
                    {"unfiltered.one", &set.unfiltered}};
    write_dump(path, set, options);
  }

  RecordSet set;
  std::vector<Rgb> rest;
};

// A run over frame `f` of `count`, with all the others.
FilterRequest window_run(const std::shared_ptr<const run::Dump>& dump, std::size_t f,
                         std::size_t count) {
  FilterRequest run = default_run();
  run.parameters.weights = filter::WeightTerms::none();
  run.parameters.weights.normal = 0.95f;
  run.parameters.weights.reflectance = 0.05f;
  run.passes = {f, f + 1};
  run.window.width = 3;
  run.window.terms = {2, true};
  for (std::size_t g = 0; g < count; ++g) {
    if (g != f) run.window.others.push_back({dump, {g, g + 1}});
  }
  return run;
}

film::Image picture_of(const run::Dump& dump, const FilterRequest& run) {
  return run::filter_dump(dump, run).pictures[0].image();
}

// The same, written from the equations.
class AllPairs {
 public:
  AllPairs(const Frames& frames, const FilterRequest& run) : set_(frames.set), run_(run) {
    for (const Rgb& x : frames.rest) rest_.push_back(triple(x));
  }

  // c_bar of record i of frame f, none where no ball that counts has a source; `doubtful`: whether
  // rounding may decide a test.
  std::optional<Triple> c_bar(std::size_t i, std::size_t f, std::size_t frames,
                              bool& doubtful) const {
    std::vector<std::size_t> all = ball(i, f, false);
    const std::vector<std::size_t> own_at_rest = ball(i, f, true);
    const Moments own = moments(own_at_rest);
    const double moved = share_moved({i});
    for (std::size_t g = 0; g < frames; ++g) {
      if (g == f) continue;
      const std::vector<std::size_t> others = ball(i, g, true);
      if (others.empty()) continue;
      if (share_moved(others) != moved) continue;
      if (!own_at_rest.empty() && share_moved(own_at_rest) != moved) continue;
      if (run_.window.terms.relit) {
        if (own.count < 8 || others.size() < 8) continue;
        const Moments its = moments(others);
        const double apart = std::abs(own.mean - its.mean);
        const double most = *run_.window.terms.relit * std::sqrt(own.error_sq + its.error_sq);
        doubtful |= std::abs(apart - most) < 1e-4 * most;
        if (apart > most) continue;
      }
      all.insert(all.end(), others.begin(), others.end());
    }
    if (all.empty()) return std::nullopt;
    Triple sum{};
    for (const std::size_t j : all) {
      for (std::size_t k = 0; k < 3; ++k) sum[k] += triple(set_.contribution[j])[k];
    }
    for (double& component : sum) component /= static_cast<double>(all.size());
    return sum;
  }
  [[nodiscard]] bool has_vertex(std::size_t i) const { return (set_.flags[i] & 1) != 0; }
  [[nodiscard]] bool is_orphan(std::size_t i, std::size_t f) const {
    return ball(i, f, false).empty();
  }

 private:
  struct Moments {
    double count = 0, mean = 0, error_sq = 0;
  };
  // The sources in the ball of i in frame g.
  [[nodiscard]] std::vector<std::size_t> ball(std::size_t i, std::size_t g, bool rest) const {
    const double r = run_.parameters.radius.r0 * double{set_.distance[i]};
    const auto place = [&](std::size_t k) { return rest ? rest_[k] : triple(set_.position[k]); };
    std::vector<std::size_t> found;
    for (std::size_t j = 200 * g; j < 200 * (g + 1); ++j) {
      if ((set_.flags[j] & 3) != 3) continue;
      const Triple apart = minus(place(j), place(i));
      const Triple colour = minus(triple(set_.reflectance[j]), triple(set_.reflectance[i]));
      const bool near = inner(apart, apart) < r * r;
      const bool passes = inner(triple(set_.normal[i]), triple(set_.normal[j])) >= 0.95 - 1e-6 &&
                          std::sqrt(inner(colour, colour)) <= 0.05;
      if (j == i || (near && passes)) found.push_back(j);
    }
    return found;
  }
  [[nodiscard]] double share_moved(const std::vector<std::size_t>& all) const {
    double moved = 0;
    for (const std::size_t j : all) moved += triple(set_.position[j]) != rest_[j] ? 1 : 0;
    return moved / static_cast<double>(all.size());
  }
  [[nodiscard]] Moments moments(const std::vector<std::size_t>& all) const {
    Moments of;
    of.count = static_cast<double>(all.size());
    std::vector<double> values;
    for (const std::size_t j : all) {
      const Triple c = triple(set_.contribution[j]);
      values.push_back(0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]);
      of.mean += values.back() / of.count;
    }
    for (const double y : values) {
      of.error_sq += (y - of.mean) * (y - of.mean) / (of.count - 1) / of.count;
    }
    return of;
  }

  const RecordSet& set_;
  const FilterRequest& run_;
  std::vector<Triple> rest_;
};

// Three frames of a cloud, whose upper half moves, brighter in the last.
Frames cloud(double share_unshaded = 0) {
  Frames frames(random_records(600, 7, share_unshaded, kOne));
  for (std::size_t i = 0; i < frames.set.size(); ++i) {
    RecordSet& set = frames.set;
    set.roughness[i] = 1;
    if (set.position[i].z > 0.5f) {
      frames.rest[i].z += 1;
      set.position[i] = Vec3(set.position[i].x + 2, set.position[i].y, frames.rest[i].z);
    }
    if (i >= 400) set.contribution[i] = set.contribution[i] * 1.5f;
  }
  return frames;
}

// What of the pictures of three frames was compared with loops over all pairs.
struct Compared {
  std::size_t all = 0, changed = 0;            // by the other frames
  std::size_t orphans = 0, still_orphans = 0;  // that other frames have sources for, and have none
};
Compared compare_with_loops(const Frames& frames, double r0, bool relit) {
  const TempFolder folder;
  frames.write(folder / "a.pvb");
  const auto dump = std::make_shared<const run::Dump>(folder / "a.pvb");
  Compared compared;
  for (std::size_t f = 0; f < 3; ++f) {
    FilterRequest run = window_run(dump, f, 3);
    run.parameters.radius.r0 = r0;
    if (!relit) run.window.terms.relit.reset();
    const run::FilterResult result = run::filter_dump(*dump, run);
    const film::Image image = result.pictures[0].image();
    run.window.others.clear();
    const film::Image alone = picture_of(*dump, run);
    const AllPairs pairs(frames, run);
    std::size_t orphans = 0;
    for (std::size_t i = 200 * f; i < 200 * (f + 1); ++i) {
      if (!pairs.has_vertex(i)) continue;
      bool doubtful = false;
      const std::optional<Triple> c = pairs.c_bar(i, f, 3, doubtful);
      orphans += c && pairs.is_orphan(i, f) ? 1u : 0u;
      if (doubtful) continue;
      const std::size_t pixel = frames.set.pixel[i];
      const float got = (*image.find("G"))[pixel], without = (*alone.find("G"))[pixel];
      INFO("frame " << f << ", record " << i);
      compared.still_orphans += c ? 0u : 1u;
      if (!c) CHECK(got == without);
      if (!c) continue;
      const double expected =
          double{frames.set.unfiltered[i].y} + double{frames.set.throughput[i].y} * (*c)[1];
      CHECK(std::abs(double{got} - expected) < 1e-5 * (1 + expected));
      CHECK((*image.find("one.G"))[pixel] == got);
      ++compared.all;
      compared.changed += got != without ? 1u : 0u;
    }
    CHECK(result.window.orphans == orphans);
    compared.orphans += orphans;
  }
  return compared;
}

TEST_CASE("A window of three frames is what loops over all pairs give") {
  for (const bool relit : {true, false}) {
    for (const double share_unshaded : {0.0, 0.3}) {
      const Compared compared = compare_with_loops(cloud(share_unshaded), 0.6, relit);
      CHECK(compared.all > 500);
      CHECK(compared.changed > (share_unshaded == 0 ? 100 : 10));
    }
  }
}

TEST_CASE("Orphans average what loops over all pairs find in other frames, without relit") {
  const Frames frames = cloud(0.8);
  const Compared without = compare_with_loops(frames, 0.3, false);
  CHECK(without.orphans > 50);
  CHECK(without.still_orphans > 50);
  const Compared relit = compare_with_loops(frames, 0.3, true);
  CHECK(relit.orphans == 0);
  CHECK(relit.still_orphans > 100);
}

TEST_CASE("A window gives the same pictures for any number of threads and every engine") {
  const TempFolder folder;
  cloud().write(folder / "a.pvb");
  const auto dump = std::make_shared<const run::Dump>(folder / "a.pvb");
  FilterRequest run = window_run(dump, 1, 3);
  run.parameters.demodulate = true;
  std::vector<film::Image> images;
  for (const std::size_t threads : {std::size_t{1}, std::size_t{2}, std::size_t{4}}) {
    const core::ThreadLimit limit(threads);
    images.push_back(picture_of(*dump, run));
  }
  CHECK(same({images[0]}, {images[1]}));
  CHECK(same({images[0]}, {images[2]}));
  run.parameters.engine = filter::EngineKind::brute;
  const film::Image brute = picture_of(*dump, run);
  CHECK(*brute.find("neighbors.Y") == *images[0].find("neighbors.Y"));
}

// A floor of 10 x 10 places and a plate of as many, as high as a crumb, which lies at `z` in frame
// 0 and has gone by 4 in each frame after. Colours of the plate are three times the floor's.
Frames plate_on_floor(std::size_t count, float z) {
  RecordSet set(200 * count);
  std::vector<Rgb> rest;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const std::size_t k = i % 200;
    const bool plate = k >= 100;
    rest.emplace_back(0.1f * static_cast<float>(k % 10), plate ? 0.001f : 0.0f,
                      0.1f * static_cast<float>(k % 100 / 10) + (plate ? z : 0.0f));
    set.position[i] = Vec3(rest[i].x, rest[i].y, rest[i].z);
    if (plate) set.position[i].x += 4 * static_cast<float>(i / 200);
    set.pixel[i] = static_cast<std::uint32_t>(k);
    set.contribution[i] = plate ? Rgb(3, 3, 3) : Rgb(1, 1, 1);
  }
  Frames frames(std::move(set));
  frames.rest = std::move(rest);
  return frames;
}

TEST_CASE("Nothing leaks from a moving object to the floor that it uncovers, nor back") {
  const TempFolder folder;
  plate_on_floor(4, 0.5f).write(folder / "a.pvb");
  const auto dump = std::make_shared<const run::Dump>(folder / "a.pvb");
  for (const bool relit : {true, false}) {
    for (std::size_t f = 0; f < 4; ++f) {
      FilterRequest run = window_run(dump, f, 4);
      if (!relit) run.window.terms.relit.reset();
      const film::Image image = picture_of(*dump, run);
      run.window.others.clear();
      const film::Image alone = picture_of(*dump, run);
      for (std::size_t pixel = 0; pixel < 200; ++pixel) {
        INFO("frame " << f << ", pixel " << pixel << ", relit " << relit);
        // In frame 0 the plate lies on the floor, and one averages the other as ever.
        const float expected = f == 0 ? (*alone.find("G"))[pixel] : pixel < 100 ? 1.0f : 3.0f;
        CHECK((*image.find("G"))[pixel] == expected);
      }
    }
  }
}

TEST_CASE("A moving object of which no path was shaded takes in itself and not the floor") {
  for (const bool shaded_later : {true, false}) {
    const TempFolder folder;
    Frames frames = plate_on_floor(3, 0.5f);
    for (std::size_t i = 0; i < frames.set.size(); ++i) {
      const bool later = i / 200 == 2;
      if (i % 200 >= 100 && !(later && shaded_later)) frames.set.flags[i] = filter::kHasVertex;
    }
    frames.write(folder / "a.pvb");
    const auto dump = std::make_shared<const run::Dump>(folder / "a.pvb");
    FilterRequest run = window_run(dump, 1, 3);
    run.window.others.erase(run.window.others.begin());  // frame 0, where the plate has not moved
    run.window.terms.relit.reset();
    const run::FilterResult result = run::filter_dump(*dump, run);
    const film::Image image = result.pictures[0].image();
    std::size_t served = 0;
    for (std::size_t pixel = 0; pixel < 200; ++pixel) {
      INFO("pixel " << pixel << ", shaded later " << shaded_later);
      const bool some = (*image.find("neighbors.Y"))[pixel] > 0;
      CHECK((*image.find("G"))[pixel] == (pixel >= 100 && some ? 3.0f : 1.0f));
      served += pixel >= 100 && some ? 1u : 0u;
    }
    CHECK(result.window.orphans == served);
    CHECK((served > 10) == shaded_later);
  }
}

TEST_CASE("What moves finds itself at rest, and not in the world") {
  const TempFolder folder;
  plate_on_floor(4, 9.0f).write(folder / "a.pvb");
  const auto dump = std::make_shared<const run::Dump>(folder / "a.pvb");
  FilterRequest run = window_run(dump, 2, 4);
  run.window.others.erase(run.window.others.begin());  // frame 0, where the plate has not moved
  run.window.terms.relit.reset();
  const film::Image at_rest = picture_of(*dump, run);
  run.window.terms.rest = false;
  const film::Image in_world = picture_of(*dump, run);
  run.window.others.clear();
  const film::Image alone = picture_of(*dump, run);
  for (std::size_t pixel = 0; pixel < 200; ++pixel) {
    const float count = (*alone.find("neighbors.Y"))[pixel];
    CHECK((*at_rest.find("neighbors.Y"))[pixel] == 3 * count);
    CHECK((*in_world.find("neighbors.Y"))[pixel] == (pixel < 100 ? 3 * count : count));
    CHECK((*at_rest.find("G"))[pixel] == (pixel < 100 ? 1.0f : 3.0f));
  }
}

TEST_CASE("Frames of another light are kept apart, and those of the same light are not") {
  const TempFolder folder;
  RecordSet set(600);
  std::mt19937 random(3);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const std::size_t k = i % 200;
    set.position[i] =
        Vec3(0.02f * static_cast<float>(k % 20), 0, 0.02f * static_cast<float>(k / 20));
    set.pixel[i] = static_cast<std::uint32_t>(k);
    const float noise = 0.4f * std::uniform_real_distribution<float>(-1, 1)(random);
    const float light = i >= 400 ? 2.0f : 1.0f;  // the last frame
    set.contribution[i] = Rgb(1, 1, 1) * (light * (1 + noise));
  }
  const Frames frames(std::move(set));
  frames.write(folder / "a.pvb");
  const auto dump = std::make_shared<const run::Dump>(folder / "a.pvb");
  FilterRequest run = window_run(dump, 1, 3);
  const auto mean = [&] {
    const film::Image image = picture_of(*dump, run);
    double sum = 0;
    for (const float value : *image.find("G")) sum += double{value} / 200;
    return sum;
  };
  const run::FilterResult apart = run::filter_dump(*dump, run);
  CHECK(std::abs(mean() - 1) < 0.05);
  // Half of the balls that are found are those of the frame with the same light.
  CHECK(apart.window.found == 400);
  CHECK(apart.window.alike <= 200);
  CHECK(apart.window.alike > 150);
  run.window.terms.relit.reset();
  CHECK(std::abs(mean() - 4.0 / 3) < 0.05);
}

TEST_CASE("What does not go with other frames is refused by name") {
  const TempFolder folder;
  cloud().write(folder / "a.pvb");
  const auto dump = std::make_shared<const run::Dump>(folder / "a.pvb");
  const auto message = [&](auto change) -> std::string {
    FilterRequest run = window_run(dump, 1, 3);
    change(run);
    try {
      run::check(*dump, run);
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::usage);
      return error.what();
    }
    return "";
  };
  CHECK(message([](FilterRequest&) {}).empty());
  CHECK(message([](FilterRequest& run) {
          run.parameters.estimator = filter::Estimator::disk;
        }).find("`window`") == 0);
  CHECK(message([](FilterRequest& run) { run.parameters.iterations = 2; }).find("`iterations`") ==
        0);
  CHECK(message([](FilterRequest& run) { run.parameters.weights.plane = 1.0f; }).find("`plane`") ==
        0);
  CHECK(message([](FilterRequest& run) { run.window.terms.relit = 0; }).find("`relit`") == 0);
  CHECK(message([](FilterRequest& run) {
          run.parameters.fit = filter::BallFit::linear;
        }).find("`fit`") == 0);
  CHECK(message([](FilterRequest& run) {
          run.parameters.fireflies = {filter::FireflyRule::Kind::spread};
        }).find("`fireflies`") == 0);
}

}  // namespace
}  // namespace psf
