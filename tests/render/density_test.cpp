// Media that are not the same everywhere: look-ups and the way of rays, transmittance and single
// scattering against closed forms, furnaces, and media that are the same everywhere after all.
#include <functional>

#include "analytic_support.h"
#include "density_support.h"
#include "light_path_scenes.h"
#include "render/light/density_walk.h"
#include "render/light/medium.h"
#include "render/scene/procedural/densities.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

using Imath::Box3d;
using Imath::V3d;
using Imath::V3i;
using Density = std::shared_ptr<const DensityGrid>;

int add_medium(Scene& scene, const Rgb& sigma_a, const Rgb& sigma_s, Density density, float g = 0) {
  Medium medium;
  medium.sigma_a = sigma_a;
  medium.sigma_s = sigma_s;
  medium.g = g;
  medium.density = std::move(density);
  scene.media.push_back(medium);
  return static_cast<int>(scene.media.size()) - 1;
}

const Box3d kBox(V3d(-1.5, -1.2, -3), V3d(1.5, 1.4, -1));
// From 0.2 at z = -3 to 2.2 at z = -1.
double ramp(const V3d& p) {
  return 0.2 + (p.z + 3);
}
// Its integral along z.
double ramp_length(double from, double to) {
  const auto f = [](double z) { return 0.2 * z + (z + 3) * (z + 3) / 2; };
  return f(to) - f(from);
}

Density noisy() {
  CloudDensity cloud;
  cloud.seed = 3;
  cloud.voxels = 32;
  cloud.amplitude = 0.7;
  return make_cloud(cloud, Imath::M44d());
}

// Mean and standard error of one colour of a pixel.
Estimate estimate_colour(const Integrator& integrator, const Ray& along, int colour,
                         std::uint64_t paths) {
  return batches(32, [&](std::uint32_t b) {
    double sum = 0;
    for (std::uint64_t i = 0; i < paths; ++i)
      sum += double{pixel(trace(integrator, along, SamplerKind::sobol, b, i))[colour]};
    return sum / static_cast<double>(paths);
  });
}

double integral_of(double end, const std::function<double(double)>& f) {
  constexpr int kSteps = 4000;
  double sum = f(0) + f(end);
  for (int k = 1; k < kSteps; ++k) sum += f(end * k / kSteps) * (k % 2 == 1 ? 4 : 2);
  return sum * end / kSteps / 3;
}

}  // namespace

TEST_CASE("Density: between the points of the lattice it is trilinear, in whatever place") {
  const auto f = [](const V3d& p) { return 9 + p.x - 2 * p.y + 0.5 * p.z + p.x * p.y * p.z / 9; };
  const Box3d box(V3d(-2, 0, 1), V3d(1, 2, 4));
  const Density grid = sampled_density(box, {3, 2, 1}, f);
  CHECK(std::abs(grid->most() - static_cast<float>(f(V3d(1, 0, 4)))) < 1e-5f);
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> unit;
  for (int k = 0; k < 1000; ++k) {
    const V3d u(unit(generator), unit(generator), unit(generator));
    // A product of three axes is what trilinear weights are made of.
    const V3d p = box.min + u * box.size();
    REQUIRE(std::abs(density_at(*grid, p) - f(p)) < 2e-5);
  }
}

TEST_CASE("Density: a ray's stretches follow each other through all that is there") {
  const Density grid = noisy();
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> unit;
  int stretches = 0, inside = 0;
  for (int k = 0; k < 300; ++k) {
    const Vec3 origin = random_direction(generator) * (k % 3 == 0 ? 0.5f : 4.0f);
    const Vec3 target = random_direction(generator) * 0.8f;
    Ray along = ray(origin, target);
    if (k % 7 == 0) along.direction = Vec3(0, k % 2 == 0 ? 1 : -1, 0);
    DensityWalk walk(*grid, along, 6);
    double end = 0;
    std::vector<std::pair<double, double>> found;
    while (walk.next()) {
      REQUIRE(walk.from() >= end);
      REQUIRE(walk.to() >= walk.from());
      REQUIRE(walk.to() <= 6);
      end = walk.to();
      found.emplace_back(walk.from(), walk.to());
      ++stretches;
      for (int n = 0; n < 4; ++n) {
        const double t = walk.from() + unit(generator) * (walk.to() - walk.from());
        const double density{walk.density(t)};
        REQUIRE(density <= double{walk.most()} * (1 + 1e-6));
        const V3d p = V3d(along.origin) + V3d(along.direction) * t;
        REQUIRE(std::abs(density - density_at(*grid, p)) < 1e-4);
      }
    }
    // Whatever is not on a stretch is empty.
    for (int n = 0; n < 64; ++n) {
      const double t = 6 * unit(generator);
      const V3d p = V3d(along.origin) + V3d(along.direction) * t;
      const bool on_stretch = std::any_of(found.begin(), found.end(), [&](const auto& s) {
        return s.first <= t + 1e-6 && t <= s.second + 1e-6;
      });
      inside += on_stretch ? 1 : 0;
      if (!on_stretch) REQUIRE(density_at(*grid, p) == 0);
    }
  }
  CHECK(stretches > 500);
  CHECK(inside > 1000);
}

TEST_CASE("Density: a slab that gets denser in a straight line lets through the closed form") {
  const Rgb sigma(0.15f, 0.5f, 1);
  Scene lamp_behind, lit;
  for (Scene* scene : {&lamp_behind, &lit}) {
    scene->medium = add_medium(*scene, sigma, Rgb(0, 0, 0), sampled_density(kBox, {2, 1, 4}, ramp));
  }
  const int lamp = add_material(lamp_behind, MaterialKind::diffuse, 0, 2);
  lamp_behind.meshes.push_back(quad({-9, -9, -5}, {18, 0, 0}, {0, 18, 0}, lamp));
  // The same slab between a wall and the lamp that lights it.
  const int wall = add_material(lit, MaterialKind::diffuse, 0.5f);
  lit.meshes.push_back(quad({-9, -9, -5}, {18, 0, 0}, {0, 18, 0}, wall));
  lit.lights.push_back(point_light({0, 0, 1}, 36));
  const auto from_behind = make(lamp_behind, "path"), from_lamp = make(lit, "direct");
  const Vec3 low(0, 0, -4);
  for (int c = 0; c < 3; ++c) {
    const double left = std::exp(-double{sigma[c]} * ramp_length(-3, -1));
    const Estimate a = estimate_colour(*from_behind, {{0.1f, 0.2f, 1}, {0, 0, -1}}, c, 1024);
    // Seen from between the slab and the wall.
    const Estimate b = estimate_colour(*from_lamp, {low, {0, 0, -1}}, c, 2048);
    CAPTURE(c, a.mean, a.error, b.mean, b.error, left);
    CHECK(std::abs(a.mean - 2 * left) < 3 * a.error + 1e-4 * left);
    CHECK(a.error < 0.02 * left + 1e-3);
    const double reflected = 0.5 / kPiD * left;
    CHECK(std::abs(b.mean - reflected) < 3 * b.error + 1e-4 * reflected);
    CHECK(b.error < 0.015 * reflected);
  }
}

TEST_CASE("Density: single scattering of a point light is its integral along the ray") {
  const double sigma_s = 0.25, sigma_t = 0.6, g = 0.4;
  const V3d lamp(0.4, 0.9, -1.3);
  Scene scene;
  const int black = add_material(scene, MaterialKind::diffuse, 0);
  scene.meshes.push_back(quad({-50, -50, -8}, {100, 0, 0}, {0, 100, 0}, black));
  scene.lights.push_back(point_light(Vec3(lamp), 5));
  scene.medium = add_medium(scene, grey(static_cast<float>(sigma_t - sigma_s)),
                            grey(static_cast<float>(sigma_s)),
                            sampled_density(kBox, {1, 1, 3}, ramp), static_cast<float>(g));
  // Along z from -1 to -3; the lamp is in the slab, so all of the light's way is.
  const double expected = integral_of(2, [&](double t) {
    const double z = -1 - t;
    const V3d to_lamp = lamp - V3d(0, 0, z);
    const double r = to_lamp.length();
    const double way = r * (ramp({0, 0, z}) + ramp(lamp)) / 2;
    const double cosine = -to_lamp.z / r;  // light goes on along +z
    const double phase = (1 - g * g) / (4 * kPiD * std::pow(1 + g * g - 2 * g * cosine, 1.5));
    return 5 * sigma_s * ramp({0, 0, z}) * std::exp(-sigma_t * (ramp_length(z, -1) + way)) * phase /
           (r * r);
  });
  check(estimate(*make(scene, "direct"), {{0, 0, 1}, {0, 0, -1}}, SamplerKind::sobol, 16384),
        expected);
}

TEST_CASE("Density: a furnace of a cloud that absorbs nothing, under a sky") {
  Scene scene;
  scene.environment.radiance = grey(1);
  scene.medium = add_medium(scene, grey(0), Rgb(2, 6, 20), noisy(), 0.5f);
  const int white = add_material(scene, MaterialKind::diffuse, 1);
  scene.spheres.push_back({"", Vec3(0.3f, -0.2f, 0.1f), 0.2f, white});
  const auto integrator = make(scene, "path", 10000);
  for (const Vec3& target : {Vec3(0, 0.3f, 0), Vec3(0.4f, 0.1f, 0.2f)}) {
    for (int c = 0; c < 3; ++c) {
      const Estimate e = estimate_colour(*integrator, ray({0.3f, 0.8f, 4}, target), c, 1024);
      CAPTURE(c, e.mean, e.error);
      CHECK(3 * e.error <= 0.05);
      CHECK(std::abs(e.mean - 1) <= 3 * e.error + 1e-4);
    }
  }
}

TEST_CASE("Density: one that is the same everywhere is the medium without it") {
  // Under a sky and a lamp with a surface; densities of 1/2 and of 1/2 and 1/4 in turn.
  Estimate found[3];
  for (int k = 0; k < 3; ++k) {
    Scene scene;
    scene.environment.radiance = Rgb(0.2f, 0.4f, 0.6f);
    const int lamp = add_material(scene, MaterialKind::diffuse, 0, 8);
    scene.spheres.push_back({"", Vec3(1.2f, 1.5f, 0.5f), 0.4f, lamp});
    const Box3d box(V3d(-1), V3d(1));
    const float scale = k == 0 ? 1 : k == 1 ? 2 : 4;
    const Density density =
        k == 0 ? nullptr
               : sampled_density(box, {2, 3, 1}, [&](const V3d&) { return k == 1 ? 0.5 : 0.25; });
    const int medium =
        add_medium(scene, Rgb(0.1f, 0.2f, 0.3f) * scale, Rgb(1.5f, 1, 0.5f) * scale, density, 0.3f);
    const int fog = add_material(scene, MaterialKind::volume, 1);
    scene.materials.back().interior = medium;
    scene.spheres.push_back({"", Vec3(0, 0, 0), 0.9f, fog});
    found[k] = estimate(*make(scene, "path", 1000), ray({0.3f, 0.4f, 4}, {0.2f, 0.1f, 0}),
                        SamplerKind::sobol, 1024);
  }
  for (int k = 1; k < 3; ++k) {
    const double error = std::hypot(found[0].error, found[k].error);
    CAPTURE(k, found[0].mean, found[0].error, found[k].mean, found[k].error);
    CHECK(error < 0.015 * found[0].mean);
    CHECK(std::abs(found[0].mean - found[k].mean) < 3 * error);
  }
}

TEST_CASE("Density: a body that is seen at its surface or in its volume reflects the same") {
  Estimate found[2];
  for (int k = 0; k < 2; ++k) {
    Scene scene;
    const int lamp = add_material(scene, MaterialKind::diffuse, 0, 4);
    scene.spheres.push_back({"", Vec3(2, 3, 1), 0.7f, lamp});
    const int body =
        add_material(scene, k == 0 ? MaterialKind::subsurface : MaterialKind::volume, 1);
    scene.materials.back().interior = add_medium(scene, grey(0.2f), grey(6), noisy(), 0.3f);
    scene.materials.back().ior = 1;
    scene.spheres.push_back({"", Vec3(0, 0.2f, 0), 0.8f, body});
    found[k] = estimate(*make(scene, "path", 1000), ray({0, 1.5f, 4}, {0.2f, 0.3f, 0}),
                        SamplerKind::sobol, 1024);
  }
  CAPTURE(found[0].mean, found[0].error, found[1].mean, found[1].error);
  const double error = std::hypot(found[0].error, found[1].error);
  CHECK(error < 0.02 * found[0].mean);
  CHECK(std::abs(found[0].mean - found[1].mean) < 3 * error);
}

TEST_CASE("Density: what shadow rays estimate is what free paths find") {
  Medium medium;
  medium.sigma_a = Rgb(1, 4, 12);
  medium.density = noisy();
  const Ray along = ray({0.1f, 0.5f, 3}, {-0.05f, 0.2f, 0});
  for (const float reach : {3.0f, std::numeric_limits<float>::infinity()}) {
    for (int c = 0; c < 3; ++c) {
      const auto mean = [&](bool shadow) {
        return batches(32, [&](std::uint32_t b) {
          double sum = 0;
          for (std::uint64_t i = 0; i < 1024; ++i) {
            Sampler numbers = sampler(SamplerKind::independent, b + (shadow ? 1000 : 0), i);
            Rgb left;
            if (shadow) {
              left = transmittance(medium, along, reach, numbers);
            } else if (track(medium, along, grey(1), reach, numbers, left).scattered) {
              left = grey(0);
            }
            sum += double{left[c]};
          }
          return sum / 1024;
        });
      };
      const Estimate free = mean(false), shadow = mean(true);
      CAPTURE(c, reach, free.mean, free.error, shadow.mean, shadow.error);
      CHECK(std::abs(free.mean - shadow.mean) < 3 * std::hypot(free.error, shadow.error));
      CHECK(shadow.error < free.error);
      CHECK(shadow.error < 0.02);
    }
  }
}

TEST_CASE("Density: the same dump for any number of threads, and after a stop") {
  Scene scene;
  scene.name = "cloud.json";
  scene.hash = "0123abcd";
  scene.cameras = {camera_at({0.3f, 0.8f, 3}, {0, 0.2f, 0}, 40)};
  scene.environment.radiance = grey(1);
  scene.lights.push_back(point_light({0.4f, 1.5f, 1}, 5));
  scene.medium = add_medium(scene, grey(0.1f), Rgb(2, 6, 20), noisy(), 0.5f);
  RenderSettings settings = tests::quiet_settings(2);
  check_same_columns(scene, settings);
  const tests::Columns columns = render_columns(scene, settings, 1);
  const auto kinds = tests::values<std::uint8_t>(columns, "kind");
  CHECK(std::count(kinds.begin(), kinds.end(), 2) > 100);
}

TEST_CASE("Density: what is grown is in its bounds, and follows from the seed") {
  const auto values = [](const DensityGrid& grid) {
    std::vector<float> all;
    for (const DensityGrid::Cell& cell : grid.cells()) {
      if (cell.values == nullptr) {
        all.push_back(cell.most);
      } else {
        all.insert(all.end(), cell.values->begin(), cell.values->end());
      }
    }
    return all;
  };
  CloudDensity cloud;
  cloud.voxels = 32;
  MistDensity mist;
  mist.box = Box3d(V3d(0), V3d(4, 1, 2));
  mist.voxels = 40;
  mist.amplitude = 0.8;
  const auto cloud_values = values(*make_cloud(cloud, Imath::M44d()));
  const auto mist_values = values(*make_mist(mist, Imath::M44d()));
  CHECK(cloud_values == values(*make_cloud(cloud, Imath::M44d())));
  for (const std::vector<float>& found : {cloud_values, mist_values}) {
    CHECK(*std::min_element(found.begin(), found.end()) >= 0);
    CHECK(*std::max_element(found.begin(), found.end()) <= 1);
    CHECK(*std::max_element(found.begin(), found.end()) > 0.5f);
  }
  ++cloud.seed;
  ++mist.seed;
  CHECK(cloud_values != values(*make_cloud(cloud, Imath::M44d())));
  CHECK(mist_values != values(*make_mist(mist, Imath::M44d())));
  // Nothing of a cloud is outside of its ball; mist thins out in a straight line.
  const Density ball = noisy();
  for (int k = 0; k < 100; ++k) {
    std::mt19937 generator(static_cast<unsigned>(k));
    const V3d d(random_direction(generator));
    REQUIRE(density_at(*ball, d * 1.001) == 0);
  }
  mist.amplitude = 0;
  const Density layers = make_mist(mist, Imath::M44d());
  CHECK(layers->size() == V3i(5, 1, 3));
  CHECK(std::abs(density_at(*layers, {3, 0.3, 1.2}) - 0.7) < 1e-6);
}
