// Cameras in volumes, in bodies and in glass: what they see against closed forms.
#include <functional>

#include "body_scenes.h"
#include "render/light/trail.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

constexpr float kSky = 2;
const Rgb kColours(0.2f, 0.5f, 1);

// What a scene is closed by, of a material.
using Closed = std::function<void(Scene&, int material)>;

void as_sphere(Scene& scene, int material) {
  scene.spheres.push_back({"", Vec3(0, 0, 0), 1.5f, material});
}

// One mesh of six faces that look outward.
Mesh block(const Vec3& low, const Vec3& high, int material) {
  const Vec3 d = high - low, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
  Mesh all;
  all.material = material;
  for (const Mesh& side :
       {quad(low, x, z, material), quad(high, -z, -x, material), quad(low, z, y, material),
        quad(high, -y, -z, material), quad(low, y, x, material), quad(high, -x, -y, material)}) {
    const auto first = static_cast<std::uint32_t>(all.positions.size());
    all.positions.insert(all.positions.end(), side.positions.begin(), side.positions.end());
    for (const auto& [a, b, c] : side.triangles)
      all.triangles.push_back({first + a, first + b, first + c});
  }
  return all;
}

// Its face at z = -1.5 is 1.5 away from the origin, as that of the sphere is everywhere.
void as_block(Scene& scene, int material) {
  scene.meshes.push_back(block({-1, -2, -1.5f}, {1.25f, 1, 0.75f}, material));
}

void as_faces(Scene& scene, int material) {
  const Vec3 low(-1, -2, -1.5f), x(2, 0, 0), y(0, 3, 0), z(0, 0, 2), high = low + x + y + z;
  for (const Mesh& side :
       {quad(low, x, z, material), quad(high, -z, -x, material), quad(low, z, y, material),
        quad(high, -y, -z, material), quad(low, y, x, material), quad(high, -x, -y, material)}) {
    scene.meshes.push_back(side);
  }
}

void as_instance(Scene& scene, int material) {
  scene.prototypes.push_back(block({-0.5f, -0.5f, -0.75f}, {0.5f, 0.5f, 0.5f}, material));
  Mat4 twice;
  twice.setScale(2);
  scene.instances.push_back({0, twice});
}

void as_moving(Scene& scene, int material) {
  Sphere sphere{"", Vec3(9, 0, 0), 1.5f, material};
  sphere.motion = {{Vec3(9, 0, 0), 1.5f}, {Vec3(0, 0, 0), 1.5f}};
  scene.spheres.push_back(sphere);
}

const Closed kClosed[] = {as_sphere, as_block, as_faces, as_instance, as_moving};

Scene with_sky() {
  Scene scene;
  scene.environment.radiance = grey(kSky);
  return scene;
}

// A body of the kind subsurface or volume, with what it absorbs and scatters by colour.
int add_filled(Scene& scene, MaterialKind kind, const Rgb& sigma_a, const Rgb& sigma_s) {
  Medium& medium = scene.media.emplace_back();
  medium.sigma_a = sigma_a;
  medium.sigma_s = sigma_s;
  const int material = add_material(scene, kind, 1);
  scene.materials.back().interior = static_cast<int>(scene.media.size()) - 1;
  scene.materials.back().ior = 1;
  return material;
}

// Along -z from the origin, at the end of the shutter.
Ray ahead() {
  return {{0, 0, 0}, {0, 0, -1}, 1};
}

Rgb mean_of(const Scene& scene, const Ray& ray, std::uint64_t paths = 16384) {
  const auto integrator = make(scene, "path", 4000);
  Rgb sum(0, 0, 0);
  for (std::uint64_t i = 0; i < paths; ++i)
    sum += pixel(trace(*integrator, ray, SamplerKind::sobol, 0, i));
  return sum * (1 / static_cast<float>(paths));
}

}  // namespace

TEST_CASE("A camera in what absorbs sees exp(-sigma distance) of the sky") {
  for (const MaterialKind kind : {MaterialKind::volume, MaterialKind::subsurface}) {
    for (const Closed& closed : kClosed) {
      Scene scene = with_sky();
      closed(scene, add_filled(scene, kind, kColours, grey(0)));
      CAPTURE(static_cast<int>(kind), &closed - kClosed);
      const Rgb seen = mean_of(scene, ahead());
      for (int c = 0; c < 3; ++c) {
        const double expected = double{kSky} * std::exp(-1.5 * double{kColours[c]});
        CHECK(double{seen[c]} == Approx(expected).epsilon(0.03));
      }
      // Behind it nothing is lost.
      CHECK(mean_of(scene, {{0, 0, 5}, {0, 0, 1}, 1}).y == Approx(double{kSky}));
    }
  }
}

TEST_CASE("A camera in what scatters all sees the sky's radiance everywhere") {
  for (const MaterialKind kind : {MaterialKind::volume, MaterialKind::subsurface}) {
    for (const Closed& closed : kClosed) {
      Scene scene = with_sky();
      closed(scene, add_filled(scene, kind, grey(0), grey(3)));
      CAPTURE(static_cast<int>(kind), &closed - kClosed);
      const Rgb seen = mean_of(scene, ahead(), 256);
      for (int c = 0; c < 3; ++c) CHECK(double{seen[c]} == Approx(double{kSky}).epsilon(0.002));
    }
  }
}

TEST_CASE("Radiance in a body is denser by the square of its index, as it is in glass") {
  for (const float ior : {1.0f, 1.5f}) {
    Scene filled = with_sky(), glass = with_sky();
    const int wax = add_filled(filled, MaterialKind::subsurface, grey(0), grey(3));
    filled.materials.back().ior = ior;
    filled.materials.back().roughness = 0;
    as_sphere(filled, wax);
    const int clear = add_material(glass, MaterialKind::glass, 1);
    glass.materials.back().ior = ior;
    as_sphere(glass, clear);
    const double expected = double{kSky} * double{ior} * double{ior};
    CAPTURE(ior);
    CHECK(double{mean_of(filled, ahead(), 256).y} == Approx(expected).epsilon(0.002));
    CHECK(double{mean_of(glass, ahead(), 256).y} == Approx(expected).epsilon(0.002));
  }
}

TEST_CASE("Volumes around each other are left one by one, and glass has no medium") {
  // 0.5 is absorbed within 0.5 of the origin, 1 from there to 1.5, and 0.1 everywhere else.
  Scene scene = with_sky();
  const int lamp = add_material(scene, MaterialKind::diffuse, 0, kSky);
  scene.meshes.push_back(quad({-9, -9, -4}, {18, 0, 0}, {0, 18, 0}, lamp));
  const int inner = add_filled(scene, MaterialKind::volume, grey(0.5f), grey(0));
  const int outer = add_filled(scene, MaterialKind::volume, grey(1), grey(0));
  scene.media.emplace_back().sigma_a = grey(0.1f);
  scene.medium = 2;
  scene.spheres.push_back({"", Vec3(0, 0, 0), 0.5f, inner});
  as_block(scene, outer);
  CHECK(double{mean_of(scene, ahead()).y} ==
        Approx(double{kSky} * std::exp(-0.25 - 1.0 - 0.25)).epsilon(0.05));
  // In between, away from the inner one.
  CHECK(double{mean_of(scene, {{0, 0, -0.75f}, {0, 0, -1}, 1}).y} ==
        Approx(double{kSky} * std::exp(-0.75 - 0.25)).epsilon(0.05));

  // In glass of index 1, closed; and between panes of it, which are not.
  for (const bool is_closed : {true, false}) {
    Scene room = with_sky();
    room.meshes.push_back(quad({-9, -9, -4}, {18, 0, 0}, {0, 18, 0}, lamp));
    room.materials = scene.materials;
    room.media = scene.media;
    room.medium = 2;
    const int glass = add_material(room, MaterialKind::glass, 1);
    room.materials.back().ior = 1;
    if (is_closed) {
      as_sphere(room, glass);
    } else {
      // Around the place, open above and below; the front is outside.
      room.meshes.push_back(quad({-1, -1, -1}, {0, 2, 0}, {2, 0, 0}, glass));
      room.meshes.push_back(quad({1, -1, -1}, {0, 2, 0}, {0, 0, 2}, glass));
      room.meshes.push_back(quad({-1, -1, -1}, {0, 0, 2}, {0, 2, 0}, glass));
      room.meshes.push_back(quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, glass));
    }
    CAPTURE(is_closed);
    CHECK(double{mean_of(room, {{0, 0, 0}, {0, 1, 0}, 1}).y} == Approx(0).margin(1e-6));
    const double way = is_closed ? 2.5 : 4;
    CHECK(double{mean_of(room, ahead()).y} ==
          Approx(double{kSky} * std::exp(-0.1 * way)).epsilon(0.02));
  }
}

TEST_CASE("A camera where bodies of a medium overlap is in one body") {
  Scene scene = with_sky();
  const int wax = add_filled(scene, MaterialKind::subsurface, grey(0.5f), grey(0));
  scene.spheres.push_back({"", Vec3(0, 0, -1), 1.5f, wax});  // to z = -2.5
  scene.spheres.push_back({"", Vec3(0, 0, 0), 0.75f, wax});
  scene.spheres.push_back({"", Vec3(0, 0, -2.5f), 0.5f, wax});  // to z = -3
  for (const float z : {0.0f, -1.5f, -2.25f, 0.6f}) {
    CAPTURE(z);
    CHECK(double{mean_of(scene, {{0, 0, z}, {0, 0, -1}}).y} ==
          Approx(double{kSky} * std::exp(-0.5 * (3 + double{z}))).epsilon(0.05));
  }
}

TEST_CASE("What a camera in a body sees of a lamp is u until the path is outside") {
  // Rough, smooth and without a boundary that refracts; a lamp is sampled from inside, or met.
  for (const Body& body : {Body{.albedo = 0.9f, .sigma_t = 2},
                           Body{.albedo = 0.9f, .ior = 1.4f, .roughness = 0.5f, .sigma_t = 2},
                           Body{.albedo = 0.9f, .ior = 1.4f, .sigma_t = 2}}) {
    Scene scene;
    const int wall = add_material(scene, MaterialKind::diffuse, 0.5f);
    const int lamp = add_material(scene, MaterialKind::diffuse, 0, 3);
    add_room(scene, {wall, lamp, wall, wall, wall, wall});
    const int wax = add_body(scene, body);
    scene.spheres.push_back({"", Vec3(0, 0, 0), 0.4f, wax});
    const auto integrator = make(scene, "path", 64);
    std::size_t outside = 0;
    for (std::uint64_t i = 0; i < 200; ++i) {
      Trail trail(i % 2 == 0 ? 2 : 1000);
      Sampler s = sampler(SamplerKind::sobol, 0, i);
      std::uint64_t rays = 0;
      const PathRecord r = integrator->trace(ahead(), s, true, rays, {{}, &trail});
      Rgb sum(0, 0, 0), carried(1, 1, 1);
      for (const PathVertex& v : trail.vertices()) {
        sum += carried * (v.emission + v.direct + v.throughput * v.background);
        carried = carried * v.throughput;
      }
      CAPTURE(i, body.ior, body.roughness, r.has_vertex);
      CHECK(std::abs(sum.y - pixel(r).y) <= 1e-4f * (1 + pixel(r).y));
      CHECK(r.coverage == 1);
      if (!r.has_vertex) continue;
      ++outside;
      CHECK(length_sq(r.position) > 0.39f * 0.39f);
      CHECK(r.distance >= std::sqrt(length_sq(r.position)) - 1e-4f);
    }
    CHECK(outside > 100);
  }
}

TEST_CASE("A camera in a body sees as much of a lamp that is sampled as of the sky that is met") {
  for (const Body& body : {Body{.albedo = 0.8f, .sigma_t = 2},
                           Body{.albedo = 0.8f, .ior = 1.4f, .roughness = 0.5f, .sigma_t = 2}}) {
    Scene sky = with_sky(), shell;
    for (Scene* scene : {&sky, &shell}) as_sphere(*scene, add_body(*scene, body));
    const int lamp = add_material(shell, MaterialKind::diffuse, 0, kSky);
    shell.materials.back().emits_two_sided = true;
    shell.spheres.push_back({"", Vec3(0, 0, 0), 50, lamp});
    const Estimate met = estimate(*make(sky, "path", 64), ahead(), SamplerKind::sobol, 1024, 16);
    const Estimate sampled =
        estimate(*make(shell, "path", 64), ahead(), SamplerKind::sobol, 1024, 16);
    CAPTURE(body.ior, met.mean, met.error, sampled.mean, sampled.error);
    const double error = std::hypot(met.error, sampled.error);
    CHECK(error < 0.02 * met.mean);
    CHECK(std::abs(met.mean - sampled.mean) < 3 * error);
  }
}
