// Motion blur: closed forms of what moves while the shutter is open, and what stays as it was.
#include <cmath>
#include <numbers>

#include "analytic_support.h"
#include "motion_support.h"
#include "render/camera/camera.h"

namespace psf::render {
namespace {

const std::string kOpenShutter = R"(, "shutter": [0, 0.5])";
// Half a unit to the right while the shutter is open.
const std::string kGoesRight =
    R"(, "keyframes": [{"frame": 0}, {"frame": 1, "translate": [1, 0, 0]}])";

// The part of the time for which the moving square covers a column of pixels, on average.
double column_coverage(std::size_t column) {
  const double x = (static_cast<double>(column) + 0.5) / 16 - 1;
  return std::clamp(std::min((x + 0.5) / 0.5, 1 - (x - 0.5) / 0.5), 0.0, 1.0);
}

void check_column_coverage(const tests::Columns& columns) {
  const auto alpha = tests::values<float>(columns, "alpha");
  const auto pixel = tests::values<std::uint32_t>(columns, "pixel");
  std::vector<double> sum(32), count(32);
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    const std::uint32_t x = pixel[i] % 32, y = pixel[i] / 32;
    if (y < 8 || y >= 24) continue;
    sum[x] += double{alpha[i]};
    count[x] += 1;
  }
  for (std::size_t x = 0; x < 32; ++x) {
    CAPTURE(x);
    CHECK(sum[x] / count[x] == Approx(column_coverage(x)).margin(0.02));
  }
}

}  // namespace

TEST_CASE("A square that moves covers each pixel for as long as it is there") {
  check_column_coverage(dump_of(moving_scene(kGoesRight, kOpenShutter), 64));
}

TEST_CASE("A camera that moves the other way sees the same") {
  const std::string keys =
      R"(, "keyframes": [{"frame": 0}, {"frame": 1, "eye": [-1, 0, 0], "target": [-1, 0, -1]}])";
  check_column_coverage(dump_of(moving_scene("", kOpenShutter + keys), 64));
}

TEST_CASE("The shutter of the command line takes the place of the camera's") {
  SceneOverrides overrides;
  overrides.shutter = Shutter{0, 0.5f};
  check_column_coverage(
      dump_of(moving_scene(kGoesRight, R"(, "shutter": [-1, 1])"), 64, overrides));
  overrides.shutter = Shutter{0, 0};
  CHECK(dump_of(moving_scene(kGoesRight, kOpenShutter), 1, overrides) ==
        dump_of(moving_scene(kGoesRight), 1));
}

TEST_CASE("A still scene with a shutter is one without, to the last byte") {
  const std::string still = moving_scene("", kOpenShutter);
  CHECK(moving_scene_of(still).hash == moving_scene_of(moving_scene("")).hash);
  CHECK(dump_of(still, 2) == dump_of(moving_scene(""), 2));
}

TEST_CASE("Every vertex lies on its shape where that is at the path's time") {
  const std::string ball = R"(, {"shape": "sphere", "material": "white", "center": [0, 0, -3],
      "radius": 0.8, "keyframes": [{"frame": 0}, {"frame": 1, "translate": [0, 0.6, 0.4], "scale": 1.5}]})";
  const std::string turning = R"(, "transform": {"translate": [0, 0, 2]}, "keyframes": [
      {"frame": 0, "translate": [0, 0, -2], "scale": 0.5},
      {"frame": 1, "translate": [0, 0, -2], "scale": 0.5, "rotate": 170, "axis": "z"}])";
  const tests::Columns columns = dump_of(moving_scene(turning, kOpenShutter, ball), 8);
  const auto position = tests::values<Vec3>(columns, "position");
  const auto rest = tests::values<Vec3>(columns, "rest_position");
  const auto time = tests::values<float>(columns, "time");
  const auto flags = tests::values<std::uint8_t>(columns, "flags");
  double off_ball = 0, off_square = 0, off_rest = 0;
  std::size_t balls = 0, squares = 0;
  for (std::size_t i = 0; i < position.size(); ++i) {
    REQUIRE((time[i] >= 0 && time[i] < 1));
    if ((flags[i] & 1) == 0) continue;
    const double t = 0.5 * double{time[i]};  // in frames
    const Imath::V3d p(position[i]), r(rest[i]);
    if (std::abs(p.z + 2) < 1e-4) {
      const double angle = t * 170 * std::numbers::pi / 180, c = std::cos(angle),
                   s = std::sin(angle);
      const Imath::V3d back(c * p.x + s * p.y, c * p.y - s * p.x, p.z);
      off_square = std::max({off_square, std::abs(back.x) - 0.25, std::abs(back.y) - 0.25});
      off_rest = std::max(off_rest, (back - r).length());
      ++squares;
    } else {
      const double scale = 1 + 0.5 * t;
      const Imath::V3d center = Imath::V3d(0, 0, -3) * scale + Imath::V3d(0, 0.6, 0.4) * t;
      const Imath::V3d outward = (p - center) / (0.8 * scale);
      off_ball = std::max(off_ball, std::abs(outward.length() - 1));
      off_rest = std::max(off_rest, (Imath::V3d(0, 0, -3) + outward * 0.8 - r).length());
      ++balls;
    }
  }
  CHECK(squares > 300);
  CHECK(balls > 300);
  CHECK(off_ball < 1e-4);
  // Eight straight lines for 85 degrees: 0.4% of the half diagonal.
  CHECK(off_square < 1e-3);
  CHECK(off_rest < 3e-3);
}

TEST_CASE(
    "What eases, or goes there and back, is where its keys say at every time of the shutter") {
  // The square goes one unit to the right: by 3 t^2 - 2 t^3, or with a triangle wave of two periods.
  struct Course {
    std::string keys;
    double (*place)(double);
  };
  const std::vector<Course> courses{
      {R"({"frame": 0, "easing": "smooth"}, {"frame": 1, "translate": [1, 0, 0]})",
       [](double t) { return t * t * (3 - 2 * t); }},
      {R"({"frame": 0}, {"frame": 0.25, "translate": [1, 0, 0]}, {"frame": 0.5},
          {"frame": 0.75, "translate": [1, 0, 0]}, {"frame": 1})",
       [](double t) { return 1 - std::abs(1 - 4 * std::fmod(t, 0.5)); }}};
  for (const Course& course : courses) {
    CAPTURE(course.keys);
    const tests::Columns columns = dump_of(
        moving_scene(R"(, "keyframes": [)" + course.keys + "]", R"(, "shutter": [0, 1])"), 4);
    const auto position = tests::values<Vec3>(columns, "position");
    const auto rest = tests::values<Vec3>(columns, "rest_position");
    const auto time = tests::values<float>(columns, "time");
    const auto flags = tests::values<std::uint8_t>(columns, "flags");
    double off = 0;
    std::size_t seen = 0;
    for (std::size_t i = 0; i < position.size(); ++i) {
      if ((flags[i] & 1) == 0) continue;
      const double moved = double{position[i].x} - double{rest[i].x};
      off = std::max(off, std::abs(moved - course.place(double{time[i]})));
      ++seen;
    }
    CHECK(seen > 300);
    // Between eight steps a smooth one is off by its second derivative, 6, times 1/8 of 1/8^2.
    CHECK(off < 0.012);
  }
}

TEST_CASE("Smooth normals turn with their mesh while the shutter is open") {
  // They lean to the right of a square that turns about the view axis, before the other one.
  const std::string turning = R"(, {"shape": "mesh", "material": "white",
      "positions": [[-0.5, -0.5, -1.5], [0.5, -0.5, -1.5], [0.5, 0.5, -1.5], [-0.5, 0.5, -1.5]],
      "triangles": [[0, 1, 2], [0, 2, 3]],
      "normals": [[0.6, 0, 0.8], [0.6, 0, 0.8], [0.6, 0, 0.8], [0.6, 0, 0.8]],
      "keyframes": [{"frame": 0}, {"frame": 1, "rotate": 90, "axis": "z"}]})";
  const tests::Columns columns = dump_of(moving_scene("", R"(, "shutter": [0, 1])", turning), 8);
  const auto position = tests::values<Vec3>(columns, "position");
  const auto normal = tests::values<Vec3>(columns, "normal");
  const auto time = tests::values<float>(columns, "time");
  const auto flags = tests::values<std::uint8_t>(columns, "flags");
  double off = 0, least = 1, most = 0;
  for (std::size_t i = 0; i < position.size(); ++i) {
    if ((flags[i] & 1) == 0 || std::abs(position[i].z + 1.5f) > 1e-4f) continue;
    const double angle = double{time[i]} * std::numbers::pi / 2;
    const Imath::V3d turned(0.6 * std::cos(angle), 0.6 * std::sin(angle), 0.8);
    off = std::max(off, (Imath::V3d(normal[i]) - turned).length());
    least = std::min(least, double{time[i]});
    most = std::max(most, double{time[i]});
  }
  CHECK(least < 0.1);
  CHECK(most > 0.9);
  // Eight straight lines for 90 degrees.
  CHECK(off < 5e-3);
}

TEST_CASE("A lens whose focus moves while the shutter is open is sharp where its keys say") {
  const Scene scene = moving_scene_of(
      moving_scene("", R"(, "lens_radius": 0.25, "focus_distance": 2, "shutter": [0, 1],
          "keyframes": [{"frame": 0}, {"frame": 1, "focus_distance": 4}])"));
  const CameraRays rays(scene.cameras.at(0));
  for (const float time : {0.0f, 0.3f, 0.5f, 1.0f}) {
    const Ray a = rays.ray({20, 10}, {0.1f, 0.5f}, time),
              b = rays.ray({20, 10}, {0.9f, 0.5f}, time);
    // Where they are side by side no longer.
    const double apart = double{b.origin.x} - double{a.origin.x};
    const double closing = double{a.direction.x} / -double{a.direction.z} -
                           double{b.direction.x} / -double{b.direction.z};
    CAPTURE(time);
    CHECK(apart > 0.1);
    CHECK(apart / closing == Approx(2 + 2 * double{time}).epsilon(1e-4));
  }
}

TEST_CASE("Lamps that move light the floor as they do on average over the time") {
  // Under the floor's normal: a ball of radiance 5 goes by at height 2; then a square.
  Scene scene;
  const int floor = test::add_material(scene, MaterialKind::diffuse, 0.5f);
  const int lamp = test::add_material(scene, MaterialKind::diffuse, 0, 5);
  scene.meshes.push_back(test::make_floor(floor));
  scene.shutter = {0, 1};
  const Ray down = test::ray({0, 1, 5}, {0, 0, 0});
  const auto over_time = [&](const auto& irradiance) {
    double sum = 0;
    for (int k = 0; k < 400; ++k) sum += irradiance((k + 0.5) / 400);
    return sum / 400;
  };
  const auto check_lamp = [&](double irradiance) {
    const auto integrator = test::make(scene, "direct");
    const test::Estimate e = test::batches(32, [&](std::uint32_t b) {
      double sum = 0;
      constexpr std::uint64_t kPaths = 4096;
      for (std::uint64_t i = 0; i < kPaths; ++i) {
        Sampler s = test::sampler(SamplerKind::sobol, b, i);
        Ray at_time = down;
        at_time.time = s.next_1d();
        std::uint64_t rays = 0;
        sum += double{test::pixel(integrator->trace(at_time, s, true, rays)).y};
      }
      return sum / kPaths;
    });
    test::check(e, 0.5 / test::kPiD * irradiance);
  };

  Sphere ball{"ball", {-2, 2, 0}, 0.5f, lamp};
  ball.motion = {{{-2, 2, 0}, 0.5f}, {{2, 2, 0}, 0.7f}};
  scene.spheres = {ball};
  check_lamp(over_time([](double t) {
    const double x = -2 + 4 * t, r = 0.5 + 0.2 * t, d_sq = x * x + 4;
    return 5 * test::kPiD * r * r / d_sq * 2 / std::sqrt(d_sq);
  }));

  scene.spheres.clear();
  // Faces down; it grows to twice its size as it goes.
  Mesh square = test::quad({-2, 2, 0}, {1, 0, 0}, {0, 0, 1}, lamp);
  const Mesh end = test::quad({1, 2, 0}, {2, 0, 0}, {0, 0, 2}, lamp);
  square.motion = {{square.positions, {}}, {end.positions, {}}};
  scene.meshes.push_back(square);
  check_lamp(over_time([](double t) {
    double sum = 0;
    const double side = 1 + t, left = -2 + 3 * t;
    for (int i = 0; i < 40; ++i) {
      for (int k = 0; k < 40; ++k) {
        const double x = left + side * (i + 0.5) / 40, z = side * (k + 0.5) / 40;
        const double d_sq = x * x + 4 + z * z;
        sum += 4 / (d_sq * d_sq);
      }
    }
    return 5 * sum * side * side / 1600;
  }));
}

TEST_CASE("Paths from the lights are refused where shapes move while the shutter is open") {
  const Scene scene = moving_scene_of(moving_scene(kGoesRight, kOpenShutter));
  for (const char* name : {"vpl", "photon"}) {
    IntegratorSettings settings;
    settings.name = name;
    CHECK_THROWS_AS(make_integrator(scene, settings), Error);
    CHECK_NOTHROW(make_integrator(moving_scene_of(moving_scene(kGoesRight)), settings));
  }
}

}  // namespace psf::render
