// What a glTF file asks for beyond what psf reads is said once, by name.
#include "catch.h"
#include "gltf_load.h"

namespace psf::render {
namespace {

json extension(const char* name, const json& value) {
  return {{"extensions", {{name, value}}}};
}

// One texture for each source; the first picture is a KTX2, the second a PNG.
void add_textures(Document& d, const json& textures) {
  d.root["images"] = {{{"uri", "data:image/ktx2;base64," +
                                   base64("\xABKTX 20\xBB\r\n\x1A\n" + std::string(200, 'x'))}},
                      {{"uri", "data:image/webp;base64," + kPng}}};
  d.root["textures"] = textures;
}

// Khronos's registry: ratified extensions, and others that files in circulation have.
const std::vector<const char*> kLeftOut = {"KHR_materials_anisotropy",
                                           "KHR_materials_dispersion",
                                           "KHR_materials_diffuse_transmission",
                                           "KHR_materials_iridescence",
                                           "KHR_materials_sheen",
                                           "KHR_materials_volume",
                                           "KHR_draco_mesh_compression",
                                           "EXT_meshopt_compression",
                                           "KHR_meshopt_compression",
                                           "KHR_gaussian_splatting",
                                           "KHR_techniques_webgl",
                                           "EXT_lights_image_based",
                                           "EXT_lights_ies",
                                           "MSFT_lod",
                                           "VENDOR_unheard_of"};
const std::vector<const char*> kHarmless = {"KHR_animation_pointer", "KHR_materials_variants",
                                            "KHR_xmp_json_ld"};
const std::vector<const char*> kRead = {"EXT_mesh_gpu_instancing",
                                        "EXT_texture_webp",
                                        "KHR_materials_clearcoat",
                                        "KHR_lights_punctual",
                                        "KHR_materials_emissive_strength",
                                        "KHR_materials_ior",
                                        "KHR_materials_pbrSpecularGlossiness",
                                        "KHR_materials_specular",
                                        "KHR_materials_transmission",
                                        "KHR_materials_unlit",
                                        "KHR_mesh_quantization",
                                        "KHR_node_visibility",
                                        "KHR_texture_basisu",
                                        "KHR_texture_transform"};

TEST_CASE("an extension that is left out is named once, one that is needed refused",
          "[load][gltf]") {
  for (const char* name : kLeftOut) {
    CAPTURE(name);
    Document d = triangle();
    d.root["extensionsUsed"] = {name};
    CHECK(notes(load(d), std::string("s.gltf: ") + name) == 1);
    d.root["nodes"][0]["extensions"] = {{name, json::object()}};
    d.root["meshes"][0]["extensions"] = {{name, json::object()}};
    CHECK(notes(load(d), name) == 1);
    CHECK(notes(load(d), " and 1 more") == 1);
    d.root["extensionsRequired"] = {name};
    CHECK(failure_of(d).message == std::string("s.gltf: /extensionsRequired: the file needs ") +
                                       name + ", which psf does not have; export it without");
  }
  for (const char* name : kHarmless) {
    Document d = triangle();
    d.root["extensionsUsed"] = d.root["extensionsRequired"] = {name};
    CHECK(notes(load(d), name) == 1);
  }
  for (const char* name : kRead) {
    Document d = triangle();
    d.root["extensionsUsed"] = d.root["extensionsRequired"] = {name};
    CHECK(load(d).warnings.size() == 1);  // that nothing gives light
  }
  // What programs keep for themselves is nobody else's.
  Document d = triangle();
  d.root["extras"] = {{"extensions", {{"VENDOR_x", 1}}}};
  CHECK(notes(load(d), "VENDOR_x") == 0);
}

TEST_CASE("what is left out of a file is named", "[load][gltf]") {
  Document d = triangle();
  const auto material = [&](const json& m) { return load(with_material(m)); };
  const json texture = {{"index", 0}};
  const auto textured = [&](const json& m, const json& sampler = json::object()) {
    Document t = with_material(m);
    add_textures(t, json::array({{{"source", 1}, {"sampler", 0}}}));
    t.root["samplers"] = json::array({sampler});
    return load(t);
  };
  const json base = {{"pbrMetallicRoughness", {{"baseColorTexture", texture}}}};
  CHECK(notes(textured({{"normalTexture", texture}}), "left out") == 0);
  CHECK(notes(textured({{"occlusionTexture", texture}}), "occlusion maps are left out") == 1);
  CHECK(notes(textured(base, {{"wrapT", 33071}}), "repeat instead") == 1);
  CHECK(notes(textured(base, {{"magFilter", 9728}}), "are interpolated") == 1);
  CHECK(textured(base).warnings.size() == 1);
  json two = base;
  two["emissiveTexture"] = {{"index", 0}, {"texCoord", 1}};
  two["emissiveFactor"] = {1, 1, 1};
  CHECK(notes(textured(two), "share the coordinates of the first") == 1);
  two["emissiveTexture"] = {{"index", 0},
                            {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}}}}}};
  CHECK(notes(textured(two), "share the coordinates of the first") == 1);
  CHECK(notes(material({{"alphaMode", "BLEND"}}), "alpha") == 0);
  CHECK(notes(material({{"alphaMode", "OPAQUE"}}), "alpha") == 0);
  CHECK(notes(material(extension("KHR_materials_transmission", {{"transmissionFactor", 0.4}})),
              "at most a half is left out") == 1);
  CHECK(notes(material({{"pbrMetalicRoughness", 1}}),
              "the key \"pbrMetalicRoughness\" is not one of glTF's and is left out; did you mean "
              "\"pbrMetallicRoughness\"?: /materials/0") == 1);

  const auto changed = [&](const auto& change) {
    Document c = triangle();
    change(c.root);
    return load(c);
  };
  CHECK(notes(changed([](json& r) {
                r["skins"] = {{{"joints", {0}}}}, r["nodes"][0]["skin"] = 0;
              }),
              "skins are left out") == 1);
  auto morph = [](json& r) { r["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}}; };
  CHECK(notes(changed(morph), "morph targets are left out") == 1);
  auto colours = [](json& r) { r["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 0; };
  CHECK(notes(changed(colours), "vertex colours are left out") == 1);
  auto lines = [](json& r) {
    r["meshes"][0]["primitives"].push_back({{"mode", 1}, {"attributes", {{"POSITION", 0}}}});
  };
  CHECK(notes(changed(lines), "points and lines are left out: /meshes/0/primitives/1") == 1);
  auto flat = [](json& r) {
    r["cameras"] = {{{"type", "orthographic"}, {"orthographic", json::object()}}};
    r["nodes"][0]["camera"] = 0;
  };
  CHECK(notes(changed(flat), "orthographic cameras are left out") == 1);
  CHECK(notes(changed([](json& r) {
                r["scenes"].push_back({{"name", "other"}});
              }),
              "scenes are left out") == 1);
  auto nothing = [](json& r) {
    r["nodes"].push_back({{"mesh", 0}, {"name", "gone"}, {"scale", {0, 0, 0}}});
    r["scenes"][0]["nodes"] = {0, 1};
  };
  const Scene scaled = changed(nothing);
  CHECK(scaled.meshes.size() == 1);
  CHECK(notes(scaled, "scaled to nothing are left out: /nodes/1 (gone)") == 1);
}

TEST_CASE("a picture that psf does not read is left out, and another takes its place",
          "[load][gltf]") {
  const json base = {{"name", "oak"},
                     {"emissiveFactor", {1, 1, 1}},
                     {"emissiveTexture", {{"index", 0}}},
                     {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}};
  Document d = with_material(base);
  add_textures(d, json::array({{{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}}));
  d.root["extensionsRequired"] = d.root["extensionsUsed"] = {"KHR_texture_basisu"};
  Scene scene = load(d);
  CHECK(scene.materials.at(0).reflectance_texture == kNone);
  CHECK(is_black(scene.materials.at(0).emission));  // a body does not glow for want of a picture
  CHECK(notes(scene,
              "a picture cannot be had and is left out (image 0, a data URI of image/ktx2: "
              "psf reads no KTX2 pictures): /materials/0 (oak): base colour and 1 more") == 1);
  for (const json& texture :
       {json{{"source", 1}, {"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}},
        json{{"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}}, json{{"source", 1}}}) {
    add_textures(d, json::array({texture}));
    scene = load(d);
    CHECK(scene.materials.at(0).reflectance_texture != kNone);
    CHECK(notes(scene, "left out") == 0);
  }
}

}  // namespace
}  // namespace psf::render
