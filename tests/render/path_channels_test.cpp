// The channels that are written on request: where a path begins, and whether it met anything.
#include <algorithm>
#include <cmath>

#include "analytic_support.h"
#include "core/error.h"
#include "render/camera/camera.h"
#include "render_dump.h"

using namespace psf;
using namespace psf::render;
using namespace psf::tests;

namespace {

constexpr std::uint32_t kSide = 32;

// A square of side 1 at distance 2 before a sky of radiance 3, in a camera whose picture is 2 wide
// there: its middle half, so a quarter of the picture, bounded by pixels.
Scene square_before_sky(MaterialKind kind = MaterialKind::diffuse, float reflectance = 0.5f) {
  Scene scene;
  const int material = test::add_material(scene, kind, reflectance);
  scene.meshes.push_back(test::quad({-0.5f, -0.5f, -2}, {1, 0, 0}, {0, 1, 0}, material));
  scene.environment.radiance = test::grey(3);
  Camera camera;
  camera.eye = Vec3(0, 0, 0);
  camera.target = Vec3(0, 0, -1);
  camera.width = camera.height = kSide;
  camera.fov = 2 * std::atan(0.5f);
  scene.cameras = {camera};
  return scene;
}

RenderSettings with_all(std::uint64_t passes) {
  RenderSettings settings = quiet_settings(passes);
  settings.channels = {"all"};
  return settings;
}

Columns columns_of(const Scene& scene, const RenderSettings& settings,
                   const Integrator& integrator) {
  const tests::TempFolder folder;
  formats::WriterOptions options;
  options.sync = false;
  {
    formats::Writer writer(folder / "a.pvb", make_head(scene, integrator, settings), options);
    (void)render::render(scene, integrator, settings, &writer);
  }
  return read_all(folder / "a.pvb");
}
Columns columns_of(const Scene& scene, const RenderSettings& settings,
                   const std::string& integrator = "path") {
  return columns_of(scene, settings, *test::make(scene, integrator));
}

}  // namespace

TEST_CASE("alpha is 1 on the square and 0 on the sky, for every integrator") {
  const Scene scene = square_before_sky();
  for (const std::string& name : integrator_names()) {
    INFO(name);
    const Columns columns = columns_of(scene, with_all(2), name);
    const auto alpha = values<float>(columns, "alpha");
    const auto pixel = values<std::uint32_t>(columns, "pixel");
    REQUIRE(alpha.size() == 2 * kSide * kSide);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < alpha.size(); ++i) {
      const std::uint32_t x = pixel[i] % kSide, y = pixel[i] / kSide;
      const bool on_square = x >= 8 && x < 24 && y >= 8 && y < 24;
      if (alpha[i] != (on_square ? 1.0f : 0.0f)) ++wrong;
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("What is seen through glass, in a mirror or from behind has met something") {
  for (const MaterialKind kind :
       {MaterialKind::glass, MaterialKind::mirror, MaterialKind::diffuse}) {
    Scene scene = square_before_sky(kind, 1);
    for (auto& triangle : scene.meshes[0].triangles) std::swap(triangle[1], triangle[2]);
    const auto alpha = values<float>(columns_of(scene, with_all(1)), "alpha");
    CHECK(std::count(alpha.begin(), alpha.end(), 1.0f) == 16 * 16);
    CHECK(std::count(alpha.begin(), alpha.end(), 0.0f) == 3 * 16 * 16);
  }
}

TEST_CASE("What is unshaded has its alpha, too") {
  RenderSettings settings = with_all(2);
  settings.shade_rate = 4;
  const auto alpha = values<float>(columns_of(square_before_sky(), settings), "alpha");
  CHECK(std::count(alpha.begin(), alpha.end(), 1.0f) == 2 * 16 * 16);
}

TEST_CASE("The floor of film is the pixel, and its rest lies anywhere in it") {
  for (const Enumeration enumeration : {Enumeration::pixel, Enumeration::global}) {
    RenderSettings settings = with_all(16);
    settings.sampler.enumeration = enumeration;
    const Columns columns = columns_of(square_before_sky(), settings);
    const auto film = values<Vec2>(columns, "film");
    const auto pixel = values<std::uint32_t>(columns, "pixel");
    std::size_t wrong = 0;
    Vec2 sum(0, 0);
    for (std::size_t i = 0; i < film.size(); ++i) {
      const Vec2 floor(std::floor(film[i].x), std::floor(film[i].y));
      const auto x = static_cast<std::uint32_t>(floor.x), y = static_cast<std::uint32_t>(floor.y);
      if (y * kSide + x != pixel[i]) ++wrong;
      sum += film[i] - floor;
    }
    CHECK(wrong == 0);
    CHECK(sum.x / static_cast<float>(film.size()) == Approx(0.5).margin(0.01));
    CHECK(sum.y / static_cast<float>(film.size()) == Approx(0.5).margin(0.01));
  }
}

TEST_CASE("In a picture so wide that floats have few digits left, film stays in its pixel") {
  Scene scene = two_camera_scene();
  scene.cameras[0].width = kMaxSide;
  scene.cameras[0].height = 2;
  for (const Enumeration enumeration : {Enumeration::pixel, Enumeration::global}) {
    RenderSettings settings = with_all(2);
    settings.sampler.kind = SamplerKind::independent;
    settings.sampler.enumeration = enumeration;
    const Columns columns = columns_of(scene, settings, FakeIntegrator());
    const auto film = values<Vec2>(columns, "film");
    const auto pixel = values<std::uint32_t>(columns, "pixel");
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < film.size(); ++i) {
      const auto x = static_cast<std::uint32_t>(film[i].x),
                 y = static_cast<std::uint32_t>(film[i].y);
      if (y * kMaxSide + x != pixel[i] || x >= kMaxSide) ++wrong;
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("The hit that film and lens lead to is the vertex of the file") {
  Scene scene = square_before_sky();
  scene.cameras[0].lens_radius = 0.125f;
  scene.cameras[0].focus_distance = 3;
  const Columns columns = columns_of(scene, with_all(16));
  const auto film = values<Vec2>(columns, "film"), lens = values<Vec2>(columns, "lens");
  const auto position = values<Vec3>(columns, "position");
  const auto flags = values<std::uint8_t>(columns, "flags");
  std::size_t vertices = 0;
  double off = 0, square = 0;
  for (std::size_t i = 0; i < film.size(); ++i) {
    square += double{lens[i].x * lens[i].x + lens[i].y * lens[i].y};
    CHECK(lens[i].length() <= 1.0001f);
    if ((flags[i] & 1) == 0) continue;
    // From the lens through the point of the plane of focus, 3 wide there, to the square.
    const double t = 2.0 / 3;
    const double at_x = (double{film[i].x} / kSide - 0.5) * 3, on_x = double{lens[i].x} * 0.125;
    const double at_y = (0.5 - double{film[i].y} / kSide) * 3, on_y = double{lens[i].y} * 0.125;
    off = std::max({off, std::abs(on_x + t * (at_x - on_x) - double{position[i].x}),
                    std::abs(on_y + t * (at_y - on_y) - double{position[i].y})});
    ++vertices;
  }
  CHECK(vertices > 3000);
  CHECK(off < 1e-5);
  CHECK(square / static_cast<double>(lens.size()) == Approx(0.5).margin(0.02));  // uniform
}

TEST_CASE("A pinhole has no lens, and psf-render no motion, no frames and surfaces alone") {
  const Columns columns = columns_of(square_before_sky(), with_all(1));
  for (const char* channel : {"lens", "time", "frame", "kind"}) {
    INFO(channel);
    const auto& bytes = columns.at(channel);
    CHECK(std::count(bytes.begin(), bytes.end(), std::byte{0}) ==
          static_cast<std::ptrdiff_t>(bytes.size()));
  }
}

TEST_CASE("Channels on request leave the others as they are, for any number of threads") {
  const Scene scene = square_before_sky();
  const Columns plain = columns_of(scene, quiet_settings(2));
  CHECK(plain.size() == 15);
  RenderSettings settings = quiet_settings(2);
  settings.channels = {"default", "alpha"};
  CHECK(columns_of(scene, settings).size() == 16);
  const Columns all = columns_of(scene, with_all(2));
  CHECK(all.size() == 22);
  for (const auto& [name, bytes] : plain) CHECK(all.at(name) == bytes);
  const core::ThreadLimit one(1);
  CHECK(columns_of(scene, with_all(2)) == all);
}

TEST_CASE("A dump with channels on request goes on as if it had never stopped") {
  const tests::TempFolder folder;
  const RenderSettings four = with_all(4);
  (void)render_to(folder / "whole.pvb", four);
  (void)render_to(folder / "part.pvb", with_all(2));
  const Scene scene = two_camera_scene();
  const FakeIntegrator integrator;
  const auto go_on = [&](const RenderSettings& settings) {
    formats::Writer writer =
        formats::Writer::resume(folder / "part.pvb", make_head(scene, integrator, settings), {});
    (void)render::render(scene, integrator, settings, &writer);
  };
  RenderSettings other = four;
  other.channels = {"default", "alpha"};
  CHECK_THROWS_AS(go_on(other), Error);
  go_on(four);
  CHECK(read_all(folder / "part.pvb") == read_all(folder / "whole.pvb"));
}
