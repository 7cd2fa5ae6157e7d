// Paths through bodies: all ways to the same light agree, and what is told of a path adds up.
#include <vector>

#include "body_scenes.h"
#include "render/light/trail.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

// A body on a floor in a box with a lamp.
Scene lit_room(const Body& body) {
  Scene scene;
  const int wall = add_material(scene, MaterialKind::diffuse, 0.5f);
  const int lamp = add_material(scene, MaterialKind::diffuse, 0, 3);
  add_room(scene, {wall, lamp, wall, wall, wall, wall});
  const int wax = add_body(scene, body);
  scene.spheres.push_back({"", Vec3(0.1f, -0.6f, 0), 0.4f, wax});
  return scene;
}

}  // namespace

TEST_CASE("Subsurface paths: path, vpl and photon find the same light") {
  for (const Body& body :
       {Body{.albedo = 0.95f, .sigma_t = 8}, Body{.albedo = 0.95f, .ior = 1.4f, .sigma_t = 8},
        Body{.albedo = 0.95f, .ior = 1.4f, .roughness = 0.6f, .sigma_t = 8}}) {
    const Scene scene = lit_room(body);
    for (const Vec3& target : {Vec3(0.1f, -0.5f, 0.1f), Vec3(0.65f, -1, 0.2f)}) {
      const Ray r = ray({0.2f, 0.4f, 0.9f}, target);
      CAPTURE(body.ior, body.roughness, target.x);
      const Estimate path = estimate(*make(scene, "path"), r, SamplerKind::sobol, 512, 16);
      CHECK(path.error < 0.03 * path.mean);
      for (const char* name : {"vpl", "photon"}) {
        // A pass of its own for each batch: its light paths are shared by all paths.
        IntegratorSettings settings;
        settings.name = name;
        settings.photon_paths = 4096;
        settings.photon_radius = 0.15f;
        settings.photon_delta = 0;
        settings.vpl_paths = 64;
        const auto all = make_integrator(scene, settings);
        const Estimate e = batches(16, [&](std::uint32_t b) {
          std::uint64_t rays = 0;
          const auto of_pass = all->for_pass({}, b, rays);
          double sum = 0;
          for (std::uint64_t i = 0; i < 128; ++i) {
            sum += double{pixel(trace(*of_pass, r, SamplerKind::sobol, b, i)).y};
          }
          return sum / 128;
        });
        CAPTURE(name, path.mean, path.error, e.mean, e.error);
        CHECK(e.error < 0.04 * e.mean);
        CHECK(std::abs(e.mean - path.mean) <
              3 * std::hypot(e.error, path.error) + 0.01 * path.mean);
      }
    }
  }
}

TEST_CASE("Subsurface paths: the vertices of a path have its light, however many are kept") {
  for (const Body& body : {Body{.albedo = 0.9f, .sigma_t = 8},
                           Body{.albedo = 0.9f, .ior = 1.4f, .roughness = 0.5f, .sigma_t = 8}}) {
    const Scene scene = lit_room(body);
    for (const std::size_t most : {std::size_t{2}, std::size_t{1000}}) {
      const auto integrator = make(scene, "path");
      for (std::uint64_t i = 0; i < 200; ++i) {
        Trail trail(most);
        Sampler s = sampler(SamplerKind::sobol, 0, i);
        std::uint64_t rays = 0;
        const PathRecord r = integrator->trace(ray({0.2f, 0.4f, 0.9f}, {0.1f, -0.5f, 0.1f}), s,
                                               true, rays, {{}, &trail});
        Rgb sum(0, 0, 0), carried(1, 1, 1);
        for (const PathVertex& v : trail.vertices()) {
          sum += carried * (v.emission + v.direct + v.throughput * v.background);
          carried = carried * v.throughput;
        }
        CAPTURE(i, most, body.ior);
        CHECK(std::abs(sum.y - pixel(r).y) <= 1e-4f * (1 + pixel(r).y));
      }
    }
  }
}

TEST_CASE(
    "Subsurface paths: what comes back from a body is the diffuse lobe's, and layers add up") {
  const Scene scene = lit_room({.albedo = 0.9f, .ior = 1.4f, .roughness = 0.5f, .sigma_t = 8});
  for (const LayerKind kind : {LayerKind::lobes, LayerKind::bounces}) {
    IntegratorSettings settings;
    settings.layers = kind;
    const auto integrator = make_integrator(scene, settings);
    float first = 0;
    for (std::uint64_t i = 0; i < 200; ++i) {
      std::vector<Rgb> c(integrator->layers().size(), grey(0)), u = c;
      Sampler s = sampler(SamplerKind::sobol, 0, i);
      std::uint64_t rays = 0;
      const PathRecord r = integrator->trace(ray({0.2f, 0.4f, 0.9f}, {0.1f, -0.5f, 0.1f}), s, true,
                                             rays, {{c, u}, nullptr});
      CHECK(std::abs(c[0].y + c[1].y - r.contribution.y) <= 1e-4f * (1 + r.contribution.y));
      first += c[0].y;
    }
    CHECK(first > 0);
  }
}
