// Layers of the light: parts of c and u that add up to them, each the light that its name says.
#include <cmath>
#include <set>

#include "analytic_support.h"
#include "core/error.h"
#include "render/light/bsdf.h"
#include "render/light/frame.h"
#include "render/light/tally.h"
#include "render/loop/recorder.h"

namespace psf::render {
namespace {

using namespace test;  // NOLINT: the set-up that these tests share

// A room with a coated floor, a mirror ball, a lamp in the ceiling, and a point light. With `lit`,
// only the light of this number emits.
Scene room(int lit = kNone) {
  Scene scene;
  const int white = add_material(scene, MaterialKind::diffuse, 0.6f);
  const int lamp = add_material(scene, MaterialKind::diffuse, 0, lit == kNone || lit == 1 ? 4 : 0);
  const int coat = add_material(scene, MaterialKind::coat, 0.5f);
  scene.materials[static_cast<std::size_t>(coat)].roughness = 0.4f;
  const int mirror = add_material(scene, MaterialKind::mirror, 0.9f);
  add_room(scene, {coat, white, white, white, white, white});
  scene.meshes.push_back(quad({-0.3f, 0.95f, -0.3f}, {0.6f, 0, 0}, {0, 0, 0.6f}, lamp));
  scene.meshes.back().name = "lamp";
  scene.spheres.push_back({"ball", {0.4f, -0.6f, 0.2f}, 0.3f, mirror});
  scene.lights.push_back(point_light({-0.5f, 0.2f, 0.4f}, lit == kNone || lit == 0 ? 1.0f : 0.0f));
  scene.lights.back().name = "bulb";
  return scene;
}

std::unique_ptr<Integrator> integrator(const Scene& scene, LayerKind layers,
                                       const std::string& name = "path", std::uint32_t split = 1) {
  IntegratorSettings settings;
  settings.name = name;
  settings.layers = layers;
  settings.split = split;
  return make_integrator(scene, settings);
}

struct Traced {
  PathRecord record;
  std::vector<Rgb> contribution, unfiltered;  // by layer
};

Traced traced(const Integrator& by, const Ray& from, std::uint64_t index) {
  Traced result;
  result.contribution.assign(by.layers().size(), Rgb(0));
  result.unfiltered.assign(by.layers().size(), Rgb(0));
  Sampler s = sampler(SamplerKind::sobol, 0, index);
  std::uint64_t rays = 0;
  result.record = by.trace(from, s, true, rays, {{result.contribution, result.unfiltered}});
  return result;
}

// Rays into the room, to its floor, walls, ball and lamp.
Ray ray_of(std::uint64_t index) {
  const float x = -1.5f + 3 * static_cast<float>(index % 13) / 12;
  const float y = -2 + 4 * static_cast<float>(index % 17) / 16;
  return ray({0, 0, 0.9f}, {x, y, -0.5f});
}

bool add_up(const std::vector<Rgb>& layers, const Rgb& whole) {
  for (int c = 0; c < 3; ++c) {
    double sum = 0;
    for (const Rgb& layer : layers) sum += double{layer[c]};
    if (!(std::abs(sum - double{whole[c]}) <= 2e-6 * std::abs(double{whole[c]}))) return false;
  }
  return true;
}

std::vector<std::string> names_of(const Integrator& by) {
  std::vector<std::string> names;
  for (const LayerInfo& layer : by.layers()) names.push_back(layer.name);
  return names;
}

TEST_CASE("Layers of every kind add up to c and u, and the path is what it is without",
          "[layers]") {
  Scene scene = room();
  scene.environment.radiance = Rgb(0.2f, 0.3f, 0.4f);
  scene.meshes.erase(scene.meshes.begin() + 3);  // a wall: the sky shines in
  for (const char* name : {"path", "direct"}) {
    for (const std::uint32_t split : {1u, 3u}) {
      const auto plain = integrator(scene, LayerKind::none, name, split);
      CHECK(plain->layers().empty());
      for (const LayerKind kind : {LayerKind::lights, LayerKind::bounces, LayerKind::lobes}) {
        const auto layered = integrator(scene, kind, name, split);
        std::size_t wrong = 0, lit = 0, seen = 0;
        for (std::uint64_t i = 0; i < 600; ++i) {
          const Traced path = traced(*layered, ray_of(i), i);
          const PathRecord same = traced(*plain, ray_of(i), i).record;
          wrong += add_up(path.contribution, path.record.contribution) ? 0u : 1u;
          wrong += add_up(path.unfiltered, path.record.unfiltered) ? 0u : 1u;
          wrong += same.contribution == path.record.contribution &&
                           same.unfiltered == path.record.unfiltered &&
                           same.position == path.record.position
                       ? 0u
                       : 1u;
          lit += is_black(path.record.contribution) ? 0u : 1u;
          seen += is_black(path.record.unfiltered) ? 0u : 1u;
        }
        INFO(name << " " << static_cast<int>(kind));
        CHECK(wrong == 0);
        CHECK(lit > 300);
        CHECK(seen > 20);
      }
    }
  }
}

TEST_CASE("The layer of a light is the picture that this light makes alone", "[layers]") {
  // Every light is sampled at x_i and the scattering does not ask for light: the same paths.
  const Scene both = room();
  const auto layered = integrator(both, LayerKind::lights, "direct");
  REQUIRE(names_of(*layered) == std::vector<std::string>{"bulb", "lamp"});
  for (const int light : {0, 1}) {
    const Scene one = room(light);
    const auto alone = integrator(one, LayerKind::none, "path");
    const auto all = integrator(both, LayerKind::lights, "path");
    const auto mean = [&](const auto& value) {
      return batches(32, [&](std::uint32_t b) {
        double sum = 0;
        for (std::uint64_t i = 0; i < 4096; ++i) sum += value(b * 4096 + i);
        return sum / 4096;
      });
    };
    const Estimate layer = mean([&](std::uint64_t i) {
      const Traced path = traced(*all, ray_of(i), i);
      const auto k = static_cast<std::size_t>(light);
      return double{(path.unfiltered[k] + path.record.throughput * path.contribution[k]).y};
    });
    const Estimate expected =
        mean([&](std::uint64_t i) { return double{pixel(traced(*alone, ray_of(i), i).record).y}; });
    CAPTURE(light, layer.mean, expected.mean, layer.error, expected.error);
    CHECK(std::abs(layer.mean - expected.mean) <=
          3 * std::hypot(layer.error, expected.error) + 1e-6);
    CHECK(3 * layer.error <= 0.05 * layer.mean);
  }
}

TEST_CASE("Bounces tell the light that comes straight to x_i from the rest", "[layers]") {
  const Scene scene = room();
  const auto path = integrator(scene, LayerKind::bounces);
  const auto direct = integrator(scene, LayerKind::none, "direct");
  REQUIRE(names_of(*path) == std::vector<std::string>{"direct", "indirect", "camera"});
  std::size_t wrong = 0, indirect = 0;
  for (std::uint64_t i = 0; i < 600; ++i) {
    const Traced all = traced(*path, ray_of(i), i);
    // The integrator `direct` is `path` cut short: the same numbers make the same light.
    wrong += all.contribution[0] == traced(*direct, ray_of(i), i).record.contribution ? 0u : 1u;
    wrong +=
        is_black(all.contribution[2]) && is_black(all.unfiltered[0]) && is_black(all.unfiltered[1])
            ? 0u
            : 1u;
    indirect += is_black(all.contribution[1]) ? 0u : 1u;
  }
  CHECK(wrong == 0);
  CHECK(indirect > 300);
}

TEST_CASE("Lobes are those of x_i: a diffuse wall has no gloss, and a coat has both", "[layers]") {
  const Scene scene = room();
  const auto by = integrator(scene, LayerKind::lobes);
  REQUIRE(names_of(*by) == std::vector<std::string>{"diffuse", "glossy", "camera"});
  std::size_t wrong = 0, coats = 0;
  double diffuse = 0, glossy = 0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Traced path = traced(*by, ray_of(i), i);
    if (!path.record.has_vertex) continue;
    const bool coat = scene.materials[path.record.material].kind == MaterialKind::coat;
    if (!coat) {
      wrong += is_black(path.contribution[1]) ? 0u : 1u;
      continue;
    }
    ++coats;
    for (int c = 0; c < 3; ++c) {
      wrong += path.contribution[0][c] >= 0 && path.contribution[1][c] >= 0 ? 0u : 1u;
    }
    diffuse += double{path.contribution[0].y};
    glossy += double{path.contribution[1].y};
  }
  CHECK(wrong == 0);
  CHECK(coats > 300);
  CHECK(diffuse > 0);
  CHECK(glossy > 0.01 * diffuse);
}

TEST_CASE("The share of the diffuse lobe is that of f", "[layers]") {
  const Scene scene = room();
  const CoatAlbedo table(1.5f);
  const Bsdf coat(scene.materials[2], scene, {0, 0}, true, &table);
  Bsdf base = coat, gloss = coat;
  base.keep(Bsdf::kDiffuse);
  gloss.keep(Bsdf::kGlossy);
  const Vec3 o = normalize(Vec3(0.3f, 0.1f, 0.8f));
  for (const Vec3& to : {Vec3(-0.3f, -0.1f, 0.8f), Vec3(0.5f, 0.5f, 0.2f), Vec3(0, 0, 1)}) {
    const Vec3 i = normalize(to);
    float pdf;
    const Rgb all = coat.evaluate(o, i, pdf), part = base.evaluate(o, i, pdf);
    const Rgb share = coat.diffuse_share(o, i);
    for (int c = 0; c < 3; ++c) CHECK(share[c] * all[c] == Approx(part[c]).epsilon(1e-5));
    CHECK(base.diffuse_share(o, i) == Rgb(1));
    CHECK(gloss.diffuse_share(o, i) == Rgb(0));
  }
}

TEST_CASE("Names of layers are names of channels, one for each name of a light", "[layers]") {
  Scene scene = room();
  scene.environment.radiance = Rgb(1);
  for (const char* name :
       {"bulb", "key light", "key_light", "sky", "normal", "gr\xC3\xBCn", "", "-x", "all"}) {
    scene.lights.push_back(point_light({0, 0, 0}, 1));
    scene.lights.back().name = name;
  }
  const auto by = integrator(scene, LayerKind::lights);
  CHECK(names_of(*by) == std::vector<std::string>{"bulb", "key_light", "key_light_2", "sky_2",
                                                  "normal_2", "gr__n", "light_7", "_x", "all_2",
                                                  "lamp", "sky"});
  for (const auto& channel : record_channels({}, by->layers())) {
    CHECK(channel.name.size() <= 56);
  }
  const auto channels = record_channels({}, by->layers());
  CHECK(channels.size() == record_channels().size() + 22);
  CHECK(channels.back().name == "unfiltered.sky");
  scene.lights.back().name = std::string(200, 'x');
  CHECK(names_of(*integrator(scene, LayerKind::lights))[8] == std::string(40, 'x'));
  for (int k = 0; k < 40; ++k) {
    scene.lights.push_back(point_light({0, 0, 0}, 1));
    scene.lights.back().name = "lamp " + std::to_string(k);
  }
  CHECK_THROWS_WITH(
      integrator(scene, LayerKind::lights),
      Catch::Matchers::ContainsSubstring("give lights that belong together one name"));
  CHECK_THROWS_WITH(integrator(scene, LayerKind::lobes, "ao"),
                    Catch::Matchers::ContainsSubstring("`layers`"));
}

TEST_CASE("The recorder has a column for each part of a layer", "[layers]") {
  const std::vector<LayerInfo> layers = {{"a"}, {"b", true, false}, {"c", false, true}};
  Recorder recorder(2, layers);
  const auto channels = record_channels({}, layers);
  std::vector<Rgb> c = {Rgb(1), Rgb(2), Rgb(3)}, u = {Rgb(4), Rgb(5), Rgb(6)};
  recorder.set(1, 0, 0, {}, {c, u});
  const auto columns = recorder.columns(channels);
  REQUIRE(columns.size() == channels.size());
  const auto value = [&](const std::string& name) {
    for (std::size_t k = 0; k < channels.size(); ++k) {
      if (channels[k].name == name) return static_cast<const Rgb*>(columns[k])[1];
    }
    return Rgb(-1);
  };
  CHECK(value("contribution.a") == Rgb(1));
  CHECK(value("unfiltered.a") == Rgb(4));
  CHECK(value("contribution.b") == Rgb(2));
  CHECK(value("unfiltered.b") == Rgb(-1));
  CHECK(value("contribution.c") == Rgb(-1));
  CHECK(value("unfiltered.c") == Rgb(6));
}

}  // namespace
}  // namespace psf::render
