// Clear coats: what glTF and JSON files say of them, and light by them against Fresnel's equations.
#include "analytic_support.h"
#include "gltf_load.h"
#include "load_support.h"
#include "render/light/bsdf.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

// Fresnel's equations for a dielectric of index 1.5, by the angles.
double fresnel_by_angles(double cosine) {
  const double a = std::acos(cosine), b = std::asin(std::sin(a) / 1.5);
  if (a < 1e-6) return 0.04;
  const double s = std::sin(a - b) / std::sin(a + b), p = std::tan(a - b) / std::tan(a + b);
  return 0.5 * (s * s + p * p);
}

Vec3 angle_direction(double cosine, double phi) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return Vec3(static_cast<float>(sine * std::cos(phi)), static_cast<float>(sine * std::sin(phi)),
              static_cast<float>(cosine));
}

const CoatAlbedo& clear_table() {
  static const CoatAlbedo kTable(1.5f);
  return kTable;
}

// A coat of this reflectance and roughness under a clear one.
Scene coated_scene(float reflectance, float roughness, float metalness, float clear,
                   float clear_roughness) {
  Scene scene;
  add_material(scene, MaterialKind::coat, reflectance);
  Material& m = scene.materials[0];
  m.roughness = roughness;
  m.metalness = metalness;
  m.clearcoat = clear;
  m.clearcoat_roughness = clear_roughness;
  return scene;
}

Bsdf clear_bsdf(const Scene& scene, const Vec2& uv = {0, 0}) {
  return Bsdf(scene.materials[0], scene, uv, true, &clear_table(), nullptr, &clear_table());
}

json clear_material(const json& extension) {
  return {{"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 0.6}}},
          {"extensions", {{"KHR_materials_clearcoat", extension}}}};
}

}  // namespace

TEST_CASE("A smooth clear coat reflects by Fresnel, and takes that off what is beneath twice",
          "[clearcoat]") {
  for (const float clear : {1.0f, 0.4f}) {
    const Scene scene = coated_scene(0.6f, 0.5f, 0.2f, clear, 0);
    Scene bare = scene;
    bare.materials[0].clearcoat = 0;
    const Bsdf whole = clear_bsdf(scene), base = clear_bsdf(bare);
    for (const double cosine : {1.0, 0.8, 0.5}) {
      const Vec3 o = angle_direction(cosine, 0), i = angle_direction(0.6, 2);
      float pdf, base_pdf;
      const double left = (1 - double{clear} * fresnel_by_angles(cosine)) *
                          (1 - double{clear} * fresnel_by_angles(0.6));
      CAPTURE(clear, cosine);
      CHECK(double{whole.evaluate(o, i, pdf).y} ==
            Approx(double{base.evaluate(o, i, base_pdf).y} * left).epsilon(2e-3));
      CHECK(pdf < base_pdf);
      // The mirror is sampled in proportion, and its weight makes up for that.
      double reflected = 0;
      int mirrored = 0;
      constexpr int kSamples = 1000;
      for (int k = 0; k < kSamples; ++k) {
        BsdfSample s;
        if (!whole.sample(o, {0.3f, 0.6f}, (static_cast<float>(k) + 0.5f) / kSamples, s)) continue;
        if (s.pdf > 0) continue;
        ++mirrored;
        reflected += double{s.weight.y} / kSamples;
        REQUIRE(s.direction.z == o.z);
      }
      CHECK(mirrored > 0);
      CHECK(reflected == Approx(double{clear} * fresnel_by_angles(cosine)).epsilon(0.02));
    }
  }
}

TEST_CASE("The lobes of a clear coat that are rough enough, and the others, are all of it",
          "[clearcoat]") {
  struct Kept {
    float roughness, clear_roughness;
    std::uint8_t smooth;
  };
  for (const Kept& c : {Kept{0.5f, 0.1f, Bsdf::kClear}, Kept{0.1f, 0.5f, Bsdf::kGlossy},
                        Kept{0.2f, 0.1f, Bsdf::kClear | Bsdf::kGlossy}, Kept{0.5f, 0.6f, 0}}) {
    const Bsdf whole = clear_bsdf(coated_scene(0.6f, c.roughness, 0, 1, c.clear_roughness));
    CAPTURE(c.roughness, c.clear_roughness);
    REQUIRE(whole.smooth_lobes(0.3f) == c.smooth);
    CHECK(whole.roughness() == 1);
    CHECK(whole.least_roughness() == std::min(c.roughness, c.clear_roughness));
    if (c.smooth == 0) continue;
    Bsdf smooth = whole, rough = whole;
    smooth.keep(c.smooth);
    rough.keep(static_cast<std::uint8_t>(whole.lobes() & ~c.smooth));
    CHECK(smooth.roughness() < 0.3f);
    CHECK(rough.least_roughness() >= 0.3f);
    const Vec3 o = angle_direction(0.7, 0), i = angle_direction(0.72, 3.1);
    float pdf, of_smooth, of_rough;
    const float all = whole.evaluate(o, i, pdf).y;
    CHECK(smooth.evaluate(o, i, of_smooth).y + rough.evaluate(o, i, of_rough).y == Approx(all));
    const float chance = whole.probability(c.smooth, o);
    CHECK(chance > 0.04f);
    CHECK(chance < 0.96f);
  }
}

TEST_CASE("A ball under a clear coat reflects no more than a white sky sends", "[clearcoat]") {
  for (const float clear_roughness : {0.0f, 0.4f}) {
    for (const float metalness : {0.0f, 1.0f}) {
      Scene scene = coated_scene(1, 0.5f, metalness, 1, clear_roughness);
      scene.spheres.push_back({"", Vec3(0, 0, 0), 1, 0});
      scene.environment.radiance = grey(1);
      for (const char* name : {"path", "vpl"}) {
        const auto integrator = make(scene, name);
        for (const float y : {0.0f, 0.6f, 0.9f}) {
          const Estimate e =
              estimate(*integrator, ray({0, y, 5}, {0, y, 0}), SamplerKind::sobol, 1024);
          CAPTURE(clear_roughness, metalness, name, y, e.mean, e.error);
          CHECK(e.mean < 1 + 3 * e.error);
          CHECK(e.mean > 0.85);
        }
      }
    }
  }
}

TEST_CASE("KHR_materials_clearcoat is a clear coat, with its pictures", "[clearcoat][load]") {
  Document d = with_material(clear_material({{"clearcoatFactor", 0.75},
                                             {"clearcoatTexture", {{"index", 0}}},
                                             {"clearcoatRoughnessFactor", 0.25},
                                             {"clearcoatRoughnessTexture", {{"index", 0}}}}));
  d.root["extensionsUsed"] = d.root["extensionsRequired"] = {"KHR_materials_clearcoat"};
  d.root["images"] = {{{"uri", "data:image/png;base64," + kPng}}};
  d.root["textures"] = {{{"source", 0}}};
  const Scene scene = load(d);
  CHECK(scene.warnings.size() == notes(scene, "nothing in the scene gives light"));
  const Material& m = scene.materials.at(0);
  CHECK(m.kind == MaterialKind::coat);
  CHECK(m.clearcoat == 0.75f);
  CHECK(m.clearcoat_roughness == 0.25f);
  // The texel is 188 of 255, as it stands.
  const double texel = 188 / 255.0;
  const Bsdf bsdf = clear_bsdf(scene, {0.5f, 0.5f});
  CHECK(double{bsdf.least_roughness()} == Approx(0.25 * texel));
  const Scene plain = load(with_material(clear_material(json::object())));
  CHECK(plain.materials.at(0).clearcoat == 0);
  CHECK(plain.hash == load(with_material({{"pbrMetallicRoughness",
                                           {{"metallicFactor", 0.0}, {"roughnessFactor", 0.6}}}}))
                          .hash);
  CHECK(load(with_material(clear_material({{"clearcoatFactor", 1.0}}))).hash != plain.hash);
}

TEST_CASE("A clear coat of JSON is that of glTF", "[clearcoat][load]") {
  const auto from_json = [](const std::string& keys) {
    const TempFolder folder;
    folder.write("c.png", decode_base64(kPng));
    return load_scene(folder.write(
        "s.json",
        R"({"materials": [{"name": "m", "kind": "coat", "reflectance": 1, "roughness": 0.6,
                     "two_sided": false)" +
            keys + R"(}], "shapes": [{"shape": "sphere", "material": "m",
                     "center": [0, 0, 0], "radius": 1}]})"));
  };
  const auto from_gltf = [](json extension, bool pictures) {
    if (pictures) {
      extension["clearcoatTexture"] = extension["clearcoatRoughnessTexture"] = {{"index", 0}};
    }
    Document d = with_material(clear_material(extension));
    d.root["images"] = {{{"uri", "data:image/png;base64," + kPng}}};
    d.root["textures"] = {{{"source", 0}}};
    return load(d);
  };
  const std::string maps = R"(, "clearcoat_map": "c.png", "clearcoat_roughness_map": "c.png")";
  const json both = {{"clearcoatFactor", 0.75}, {"clearcoatRoughnessFactor", 0.25}};
  const json full = {{"clearcoatFactor", 1.0}, {"clearcoatRoughnessFactor", 1.0}};
  const std::string numbers = R"(, "clearcoat": 0.75, "clearcoat_roughness": 0.25)";
  struct Pair {
    Scene ours, theirs;
  };
  for (const Pair& pair :
       {Pair{from_json(numbers), from_gltf(both, false)},
        Pair{from_json(numbers + maps), from_gltf(both, true)},
        Pair{from_json(maps), from_gltf(full, true)},
        Pair{from_json(R"(, "clearcoat": 1)"), from_gltf({{"clearcoatFactor", 1.0}}, false)},
        Pair{from_json(""), from_gltf(json::object(), false)}}) {
    const Material &a = pair.ours.materials.at(0), &b = pair.theirs.materials.at(0);
    CAPTURE(a.clearcoat, a.clearcoat_roughness, a.clearcoat_texture);
    CHECK(a.kind == b.kind);
    CHECK(a.ior == b.ior);
    CHECK(a.clearcoat == b.clearcoat);
    CHECK(a.clearcoat_roughness == b.clearcoat_roughness);
    const Bsdf one = clear_bsdf(pair.ours, {0.5f, 0.5f}),
               other = clear_bsdf(pair.theirs, {0.5f, 0.5f});
    CHECK(one.least_roughness() == other.least_roughness());
    const Vec3 o = angle_direction(0.7, 0), i = angle_direction(0.72, 3.1);
    float pdf, other_pdf;
    CHECK(one.evaluate(o, i, pdf) == other.evaluate(o, i, other_pdf));
    CHECK(pdf == other_pdf);
    CHECK(pdf > 0);
  }
}

TEST_CASE("What of a clear coat is left out is said", "[clearcoat][load]") {
  const auto told = [](json extension, bool base_normals) {
    json material = clear_material(extension);
    if (base_normals) material["normalTexture"] = {{"index", 0}};
    Document d = with_material(material);
    d.root["images"] = {{{"uri", "data:image/png;base64," + kPng}}};
    d.root["textures"] = {{{"source", 0}}};
    return notes(load(d), "a clear coat has the relief of what is beneath it");
  };
  const json normals = {{"index", 0}};
  CHECK(told({{"clearcoatFactor", 1.0}}, false) == 0);
  CHECK(told({{"clearcoatFactor", 1.0}}, true) == 1);
  CHECK(told({{"clearcoatFactor", 1.0}, {"clearcoatNormalTexture", normals}}, false) == 1);
  CHECK(told({{"clearcoatFactor", 1.0}, {"clearcoatNormalTexture", normals}}, true) == 0);
  CHECK(told({{"clearcoatFactor", 0.0}, {"clearcoatNormalTexture", normals}}, false) == 0);

  json glass = clear_material({{"clearcoatFactor", 1.0}});
  glass["pbrMetallicRoughness"]["roughnessFactor"] = 0;
  glass["extensions"]["KHR_materials_transmission"] = {{"transmissionFactor", 1.0}};
  const Scene scene = load(with_material(glass));
  CHECK(notes(scene, "KHR_materials_clearcoat on what is no metallic-roughness") == 1);
  CHECK(scene.materials.at(0).clearcoat == 0);
  CHECK(failure_of(with_material(clear_material({{"clearcoatFactor", 2}}))).message ==
        "s.gltf:1: /materials/0/extensions/KHR_materials_clearcoat/clearcoatFactor: expected a "
        "number in [0, 1], got 2");
}
