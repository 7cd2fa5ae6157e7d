// Scenes for the integrators that use light paths, and estimates pass by pass.
#pragma once

#include "analytic_support.h"
#include "core/parallel.h"
#include "formats/write/writer.h"
#include "render_dump.h"

namespace psf::render::test {

// A mesh of one smooth normal for two faces that meet at an edge, a roof over the floor.
inline Mesh roof(const Vec3& center, int material) {
  Mesh mesh;
  const float h = 0.15f, w = 0.3f;
  mesh.positions = {center + Vec3(-w, 0, -w), center + Vec3(-w, 0, w), center + Vec3(0, h, w),
                    center + Vec3(0, h, -w),  center + Vec3(w, 0, w),  center + Vec3(w, 0, -w)};
  const Vec3 left = Vec3(-1, 1.2f, 0).normalized(), right = Vec3(1, 1.2f, 0).normalized();
  mesh.normals = {left, left, Vec3(0, 1, 0), Vec3(0, 1, 0), right, right};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {2, 4, 5}, {2, 5, 3}};
  mesh.material = material;
  return mesh;
}

// A room with walls of several kinds, a lamp, an interpolated roof, and balls of glass and metal.
inline Scene full_room() {
  Scene scene;
  const int white = add_material(scene, MaterialKind::diffuse, 0.7f);
  const int coat = add_material(scene, MaterialKind::coat, 0.5f);
  scene.materials.back().roughness = 0.2f;  // smoother than vertex_roughness, over a diffuse base
  const int metal = add_material(scene, MaterialKind::conductor, 0.8f);
  scene.materials.back().roughness = 0.5f;
  const int lamp = add_material(scene, MaterialKind::diffuse, 0, 6);
  const int glass = add_material(scene, MaterialKind::glass, 0.95f);
  add_room(scene, {white, white, coat, white, metal, white});
  scene.meshes.push_back(quad({-0.4f, 0.9f, -0.4f}, {0.8f, 0, 0}, {0, 0, 0.8f}, lamp));
  scene.meshes.push_back(roof({-0.4f, -0.9f, 0.3f}, white));
  scene.spheres.push_back({"", {0.5f, -0.6f, 0.4f}, 0.3f, glass});
  return scene;
}

// A lamp, a sun and a sky of two halves over a floor, a wall and a ball.
inline Scene open_scene() {
  Scene scene;
  const int white = add_material(scene, MaterialKind::diffuse, 0.7f);
  const int lamp = add_material(scene, MaterialKind::diffuse, 0.1f, 3);
  scene.meshes.push_back(make_floor(white, 1));
  scene.meshes.push_back(quad({-0.6f, 0, -0.6f}, {1.2f, 0, 0}, {0, 0.8f, 0}, white));
  scene.spheres.push_back({"", {0.4f, 0.25f, 0}, 0.25f, white});
  scene.spheres.push_back({"", {-0.4f, 0.6f, 0.1f}, 0.1f, lamp});
  Light sun;
  sun.kind = LightKind::directional;
  sun.direction = Vec3(-1, -1, -0.5f).normalized();
  sun.intensity = grey(1);
  sun.angle = 0.1f;
  scene.lights.push_back(sun);
  scene.environment.radiance = grey(0.2f);
  scene.environment.texture = 0;
  scene.textures.emplace_back(2, 2, std::vector<Rgb>{grey(1), grey(5), grey(1), grey(5)});
  return scene;
}

// Mean of green over runs of their own seeds, of `passes` passes with `paths` paths each.
inline Estimate estimate_passes(const Integrator& integrator, const Ray& camera_ray,
                                SamplerKind kind, std::uint64_t passes, std::uint64_t paths = 1,
                                std::uint32_t count = 16) {
  return batches(count, [&](std::uint32_t b) {
    SamplerSettings settings;
    settings.kind = kind;
    settings.seed = 100 + b;
    double sum = 0;
    std::uint64_t rays = 0;
    for (std::uint64_t pass = 0; pass < passes; ++pass) {
      const auto made = integrator.for_pass(settings, pass, rays);
      const Integrator& tracer = made != nullptr ? *made : integrator;
      for (std::uint64_t path = 0; path < paths; ++path) {
        Sampler s(settings, 0, pass * paths + path);
        sum += double{pixel(tracer.trace(camera_ray, s, true, rays)).y};
      }
    }
    return sum / static_cast<double>(passes * paths);
  });
}

// Of a picture: the mean of green, over runs of their own seeds.
inline Estimate estimate_picture(const Scene& scene, const IntegratorSettings& integrator,
                                 std::uint64_t passes, std::uint32_t count = 12) {
  const auto made = make_integrator(scene, integrator);
  return batches(count, [&](std::uint32_t b) {
    RenderSettings settings = tests::quiet_settings(passes);
    settings.integrator = integrator;
    settings.sampler.seed = 1 + b;
    const auto mean = render::render(scene, *made, settings, nullptr).films[0].mean();
    double sum = 0;
    for (std::size_t k = 1; k < mean.size(); k += 3) sum += double{mean[k]};
    return 3 * sum / static_cast<double>(mean.size());
  });
}

inline Camera camera_at(const Vec3& eye, const Vec3& target, std::uint32_t size) {
  Camera camera;
  camera.eye = eye;
  camera.target = target;
  camera.fov = 1;
  camera.width = camera.height = size;
  return camera;
}

// All columns of a render of this scene on so many threads. With `stop`, it ends after that many
// passes and goes on.
inline tests::Columns render_columns(const Scene& scene, const RenderSettings& settings,
                                     std::size_t threads, std::uint64_t stop = 0) {
  const tests::TempFolder folder;
  const std::string path = folder / "a.pvb";
  const core::ThreadLimit limit(threads);
  const auto integrator = make_integrator(scene, settings.integrator);
  const formats::Head head = make_head(scene, *integrator, settings);
  formats::WriterOptions options;
  options.sync = false;
  if (stop > 0) {
    RenderSettings first = settings;
    first.passes = stop;
    formats::Writer writer(path, head, options);
    (void)render::render(scene, *integrator, first, &writer);
  }
  if (stop > 0) {
    formats::Writer writer = formats::Writer::resume(path, head, options);
    (void)render::render(scene, *integrator, settings, &writer);
  } else {
    formats::Writer writer(path, head, options);
    (void)render::render(scene, *integrator, settings, &writer);
  }
  return tests::read_all(path);
}

// The same bytes for any number of threads, and after a stop.
inline void check_same_columns(const Scene& scene, const RenderSettings& settings) {
  const tests::Columns whole = render_columns(scene, settings, 1);
  CHECK(render_columns(scene, settings, 3) == whole);
  CHECK(render_columns(scene, settings, 2, 1) == whole);
}

// Within three standard errors of each other, where those are at most `least` of the value.
inline void check_agree(const Estimate& a, const Estimate& b, double least) {
  CAPTURE(a.mean, a.error, b.mean, b.error);
  const double error = std::hypot(a.error, b.error);
  CHECK(error < least * b.mean);
  CHECK(std::abs(a.mean - b.mean) < 3 * error);
}

}  // namespace psf::render::test
