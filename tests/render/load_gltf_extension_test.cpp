// Extensions of glTF that psf reads, and the values of what a file leaves out.
#include <ImathBox.h>

#include <numbers>

#include "catch.h"
#include "gltf_document.h"
#include "gltf_load.h"
#include "load_support.h"

namespace psf::render {
namespace {

Material material_of(const json& material) {
  Document d = triangle();
  d.root["materials"] = json::array({material});
  d.root["meshes"][0]["primitives"][0]["material"] = 0;
  return load(d).materials.at(0);
}

double reflectance_at_normal(double ior) {
  return std::pow((ior - 1) / (ior + 1), 2);
}

TEST_CASE("instances stand where their attributes put them, in the node's space", "[load][gltf]") {
  Document d = triangle();
  const int moved = d.accessor(std::vector<float>{0, 0, 0, 5, 0, 0, 0, 0, 7}, 5126, "VEC3", 3);
  // A quarter turn about z as bytes: the second.
  const int turned = d.accessor(std::vector<std::int8_t>{0, 0, 0, 127, 0, 0, 90, 90, 0, 0, 0, 127},
                                5120, "VEC4", 4);
  d.root["accessors"].back()["normalized"] = true;
  const int scaled = d.accessor(std::vector<float>{1, 1, 1, 1, 1, 1, 3, 3, 3}, 5126, "VEC3", 3);
  d.root["nodes"][0]["translation"] = {0, 100, 0};
  d.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", moved}, {"ROTATION", turned}, {"SCALE", scaled}};
  const Scene scene = load(d);
  REQUIRE(scene.meshes.size() == 1);
  const Mesh& mesh = scene.meshes[0];
  REQUIRE(mesh.triangles.size() == 3);
  check_point(mesh.positions.at(1), {1, 100, 0});
  check_point(mesh.positions.at(4), {5, 101, 0});
  check_point(mesh.positions.at(5), {3, 100, 0});
  check_point(mesh.positions.at(7), {3, 100, 7});
  d.root["accessors"].back()["count"] = 2;
  const TempFolder folder;
  CHECK(contains(load_failure(folder.write("s.gltf", d.gltf())).message,
                 "/attributes/SCALE: the attributes have different counts"));
}

TEST_CASE("a file with instances that a scene includes keeps them", "[load][gltf][json]") {
  // A strip of 16 triangles, 4,096 times.
  Document d = triangle();
  std::vector<float> strip, places;
  for (int k = 0; k < 18; ++k) {
    for (const int v : {k / 2, k % 2, 0}) strip.push_back(static_cast<float>(v));
  }
  for (int k = 0; k < 4096; ++k) {
    for (const int v : {k % 64 * 10, 0, k / 64 * 10}) places.push_back(static_cast<float>(v));
  }
  json& primitive = d.root["meshes"][0]["primitives"][0];
  primitive = {{"attributes", {{"POSITION", d.accessor(strip, 5126, "VEC3", 3)}}}, {"mode", 5}};
  d.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", d.accessor(places, 5126, "VEC3", 3)}};
  const TempFolder folder;
  const Scene alone = load_scene(folder.write("m.gltf", d.gltf()));
  REQUIRE(alone.instances.size() == 4096);
  const Scene scene = load_scene(folder.write("s.json", R"({"shapes": [{"shape": "mesh",
      "file": "m.gltf", "transform": {"translate": [0, 5, 0]},
      "repeat": {"count": 2, "step": {"translate": [0, 0, 1000]}}}]})"));
  CHECK(scene.meshes.empty());
  REQUIRE(scene.instances.size() == 8192);
  Imath::Box3f box;
  for (const Instance& instance : scene.instances) {
    for (const Vec3& p : scene.prototypes.at(instance.prototype).positions) {
      box.extendBy(p * instance.placement);
    }
  }
  check_point(box.min, {0, 5, 0});
  check_point(box.max, {638, 6, 1630});
}

TEST_CASE("a hidden node hides its children", "[load][gltf]") {
  Document d = triangle();
  d.root["nodes"] = {
      {{"children", {1}}, {"extensions", {{"KHR_node_visibility", {{"visible", true}}}}}},
      {{"mesh", 0}},
      {{"mesh", 0}}};
  d.root["scenes"][0]["nodes"] = {0, 2};
  CHECK(load(d).meshes.size() == 2);
  d.root["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = false;
  CHECK(load(d).meshes.size() == 1);
}

TEST_CASE("specular-glossiness becomes a coat of the same colours", "[load][gltf]") {
  const auto of = [](const json& values) {
    return material_of({{"extensions", {{"KHR_materials_pbrSpecularGlossiness", values}}}});
  };
  const Material matte = of({{"diffuseFactor", {0.5, 0.25, 0, 1}},
                             {"specularFactor", {0, 0, 0}},
                             {"glossinessFactor", 0.25}});
  check_color(matte.reflectance, {0.5f, 0.25f, 0});
  CHECK(matte.metalness == 0);
  CHECK(matte.ior == 1);
  CHECK(matte.roughness == 0.75f);
  const Material plastic = of({{"specularFactor", {0.05, 0.05, 0.05}}});
  CHECK(reflectance_at_normal(double{plastic.ior}) == Approx(0.05).epsilon(1e-4));
  const Material brass = of({{"diffuseFactor", {0, 0, 0, 1}}, {"specularFactor", {0.9, 0.7, 0.3}}});
  CHECK(double{brass.metalness} == Approx(1).margin(1e-3));
  check_color(brass.reflectance, {0.9f, 0.7f, 0.3f}, 2e-3);
  // Without a word: white, specular 1, glossiness 1.
  const Material empty = of(json::object());
  CHECK(empty.roughness == 0);
  CHECK(double{empty.metalness} == Approx(1).margin(1e-3));
}

TEST_CASE("index and specular factor give the reflectance of a coat", "[load][gltf]") {
  const auto ior = [](const json& extensions) {
    return double{material_of({{"extensions", extensions}}).ior};
  };
  CHECK(ior(json::object()) == 1.5);
  CHECK(ior({{"KHR_materials_ior", {{"ior", 1.8}}}}) == Approx(1.8));
  CHECK(ior({{"KHR_materials_specular", json::object()}}) == Approx(1.5).epsilon(1e-4));
  CHECK(ior({{"KHR_materials_specular", {{"specularFactor", 0}}}}) == Approx(1));
  CHECK(reflectance_at_normal(ior({{"KHR_materials_specular", {{"specularFactor", 0.5}}}})) ==
        Approx(0.02).epsilon(1e-4));
  CHECK(reflectance_at_normal(ior({{"KHR_materials_ior", {{"ior", 2}}},
                                   {"KHR_materials_specular", {{"specularFactor", 0.25}}}})) ==
        Approx(1.0 / 36).epsilon(1e-4));
  // An index of 0 stands for a reflectance of specularColorFactor.
  CHECK(reflectance_at_normal(
            ior({{"KHR_materials_ior", {{"ior", 0}}},
                 {"KHR_materials_specular", {{"specularColorFactor", {0.1, 0.1, 0.1}}}}})) ==
        Approx(0.1).epsilon(1e-4));
}

TEST_CASE("an unlit material shines in its colour and reflects nothing", "[load][gltf]") {
  const Material m =
      material_of({{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 0, 1}}}},
                   {"extensions", {{"KHR_materials_unlit", json::object()}}}});
  CHECK(m.emission == Rgb(0.5f, 0.25f, 0));
  CHECK(is_black(m.reflectance));
}

TEST_CASE("what a file leaves out has glTF's values", "[load][gltf]") {
  for (const json& said : {json::object(), json{{"pbrMetallicRoughness", json::object()}}}) {
    const Material m = material_of(said);
    CHECK(m.reflectance == Rgb(1));
    CHECK(m.roughness == 1);
    CHECK(m.metalness == 1);
    CHECK(is_black(m.emission));
    CHECK(!m.two_sided);
    CHECK(m.name == "material 0");
  }
  Document d = triangle();
  d.root["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"spot", json::object()}}};
  d.root["nodes"][0]["extensions"] = {{"KHR_lights_punctual", {{"light", 0}}}};
  const Light light = load(d).lights.at(0);
  CHECK(light.intensity == Rgb(1));
  CHECK(double{light.cos_inner} == 1);
  CHECK(double{light.cos_outer} == Approx(std::cos(std::numbers::pi / 4)));
}

TEST_CASE("a camera without aspect ratio takes that of the picture", "[load][gltf]") {
  Document d = triangle();
  d.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}};
  d.root["nodes"][0]["camera"] = 0;
  const auto vertical = [](const Camera& c) {
    return 2 * std::atan(std::tan(double{c.fov} / 2) * c.height / c.width);
  };
  for (const Vec2& size : {Vec2(512, 512), Vec2(300, 100), Vec2(100, 300)}) {
    SceneOverrides overrides;
    overrides.size = size;
    CHECK(vertical(load(d, overrides).cameras.at(0)) == Approx(1.0).epsilon(1e-5));
  }
  CHECK(vertical(load(d).cameras.at(0)) == Approx(1.0).epsilon(1e-5));
  SceneOverrides overrides;
  overrides.fov = 30.0f;
  overrides.size = Vec2(200, 100);
  CHECK(double{load(d, overrides).cameras.at(0).fov} == Approx(std::numbers::pi / 6));
  // With one, a picture of another shape keeps the horizontal angle.
  d.root["cameras"][0]["perspective"]["aspectRatio"] = 1.0;
  overrides.fov.reset();
  CHECK(double{load(d, overrides).cameras.at(0).fov} == Approx(1.0).epsilon(1e-5));
}

}  // namespace
}  // namespace psf::render
