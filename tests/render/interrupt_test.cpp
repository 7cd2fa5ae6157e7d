// ^C in the midst of a pass: what becomes whole within a second is kept, what does not is dropped.
#include "core/interrupt.h"

#include <atomic>
#include <chrono>
#include <thread>

#include "body_scenes.h"
#include "render_dump.h"

namespace psf::tests {
namespace {

using namespace std::chrono_literals;

// Interrupts at the path of this number, and takes its time from there on.
class Interrupting : public FakeIntegrator {
 public:
  Interrupting(std::uint64_t at, std::chrono::milliseconds a_path) : at_(at), a_path_(a_path) {}
  PathRecord trace(const Ray& ray, Sampler& sampler, bool shade, std::uint64_t& rays,
                   const PathDetails& details) const override {
    const std::uint64_t path = traced_++;
    if (path == at_) core::interrupt();
    if (path >= at_) std::this_thread::sleep_for(a_path_);
    return FakeIntegrator::trace(ray, sampler, shade, rays, details);
  }
  [[nodiscard]] std::uint64_t traced() const { return traced_; }

 private:
  std::uint64_t at_;
  std::chrono::milliseconds a_path_;
  mutable std::atomic<std::uint64_t> traced_{0};
};

struct Uninterrupted {
  ~Uninterrupted() { core::clear_interrupt(); }
};

RenderSettings of_both(std::uint64_t passes) {
  RenderSettings settings = quiet_settings(passes);
  settings.cameras = {0, 1};
  return settings;
}

RenderResult interrupted_render(const std::string& path, const Interrupting& integrator) {
  const Uninterrupted after;
  const Scene scene = two_camera_scene();
  const RenderSettings settings = of_both(4);
  formats::WriterOptions options;
  options.sync = false;
  formats::Writer writer(path, make_head(scene, integrator, settings), options);
  return render::render(scene, integrator, settings, &writer);
}

}  // namespace

TEST_CASE("A pass that is not whole a second after ^C leaves nothing behind") {
  const TempFolder folder;
  // In the second camera of the second pass, whose first one has been written.
  const Interrupting slow(kLeft + kRight + kLeft + 900, 20ms);
  const RenderResult result = interrupted_render(folder / "a.pvb", slow);
  CHECK(slow.traced() < 2 * (kLeft + kRight));
  CHECK(result.interrupted);
  CHECK(result.passes == 1);
  CHECK(result.paths == kLeft + kRight);
  const formats::Reader reader(folder / "a.pvb");
  CHECK(reader.records() == kLeft + kRight);
  CHECK(reader.uncommitted_bytes() == 0);
  CHECK_FALSE(reader.closed());
  const RenderResult one = render_to(folder / "b.pvb", of_both(1));
  CHECK(read_all(folder / "a.pvb") == read_all(folder / "b.pvb"));
  for (std::size_t camera = 0; camera < 2; ++camera)
    CHECK(result.films[camera].mean() == one.films[camera].mean());
}

TEST_CASE("A first pass that is not whole a second after ^C leaves no file") {
  const TempFolder folder;
  const RenderResult result = interrupted_render(folder / "a.pvb", {100, 20ms});
  CHECK(result.interrupted);
  CHECK(result.passes == 0);
  CHECK(result.paths == 0);
  CHECK(folder.file_count() == 0);
}

TEST_CASE("A pass that is whole within a second of ^C is kept") {
  const TempFolder folder;
  const RenderResult result = interrupted_render(folder / "a.pvb", {kLeft + kRight + 900, 0ms});
  CHECK(result.interrupted);
  CHECK(result.passes == 2);
  CHECK(formats::Reader(folder / "a.pvb").records() == 2 * (kLeft + kRight));
}

TEST_CASE("A walk in a body ends where its pass is overdue") {
  Scene scene;
  const int material = render::test::add_body(scene, {.ior = 1.4f, .sigma_t = 1e5f});
  scene.spheres.push_back({"", Vec3(0, 0, 0), 1, material});
  const auto integrator = render::test::make(scene, "path");
  const auto rays_of_path = [&] {
    Sampler sampler = render::test::sampler(SamplerKind::sobol, 0, 3);
    std::uint64_t rays = 0;
    static_cast<void>(integrator->trace({{0, 0, 0}, {0, 0, 1}}, sampler, true, rays));
    return rays;
  };
  CHECK(rays_of_path() > 10'000);
  const Uninterrupted after;
  core::interrupt();
  CHECK(rays_of_path() > 10'000);
  std::this_thread::sleep_for(1100ms);
  CHECK(rays_of_path() < 100);
}

TEST_CASE("Walks that are scattered very often play roulette, and keep their mean") {
  // From the middle a walk is scattered some 80,000 times before it is outside.
  Scene scene;
  const int material = render::test::add_body(scene, {.sigma_t = 400});
  scene.spheres.push_back({"", Vec3(0, 0, 0), 1, material});
  scene.environment.radiance = render::test::grey(1);
  const auto integrator = render::test::make(scene, "path");
  int once = 0, ended = 0, more = 0;
  const render::test::Estimate e = render::test::batches(8, [&](std::uint32_t b) {
    double sum = 0;
    for (std::uint64_t i = 0; i < 64; ++i) {
      const double seen =
          double{render::test::pixel(render::test::trace(*integrator, {{0, 0, 0}, {0, 0, 1}},
                                                         SamplerKind::independent, b, i))
                     .y};
      ++(seen == 0 ? ended : seen < 1.5 ? once : more);
      sum += seen;
    }
    return sum / 64;
  });
  CAPTURE(e.mean, e.error, once, ended, more);
  CHECK(once > 50);
  CHECK(ended > 50);
  CHECK(more > 50);
  CHECK(std::abs(e.mean - 1) < 0.2);
}

}  // namespace psf::tests
