// What a glTF file needs and psf lacks is refused by name, and every number is checked where it
// stands.
#include "catch.h"
#include "gltf_load.h"

namespace psf::render {
namespace {

TEST_CASE("a file that is not glTF 2.0 is refused by its version", "[load][gltf]") {
  const TempFolder folder;
  const auto message = [&](const std::string& text) {
    const Failure failure = load_failure(folder.write("s.gltf", text));
    CHECK(failure.code == ErrorCode::bad_input);
    return failure.message;
  };
  CHECK(message(R"({"asset": {"version": "1.0"}})") == "s.gltf: is glTF 1.0, psf reads 2.0");
  CHECK(message(R"({"scenes": {"s": {}}})") == "s.gltf: is glTF 1.0, psf reads 2.0");
  CHECK(message(R"({"asset": {"version": "3.1"}})") == "s.gltf: is glTF 3.1, psf reads 2.0");
  CHECK(message(R"({"asset": {"version": "2.1", "minVersion": "2.1"}})") ==
        "s.gltf: needs glTF 2.1 (/asset/minVersion), psf reads 2.0");
  CHECK(message(R"({"asset": {"version": 2}})") ==
        "s.gltf:1: /asset/version: expected a text in quotes, got 2");
  CHECK(message(R"({"nodes": []})") == "s.gltf:1: /: the key \"asset\" is missing");
  std::string old = triangle().glb();
  old[4] = 1;
  CHECK(load_failure(folder.write("s.glb", old)).message == "s.glb: is glTF 1.0, psf reads 2.0");
  Document later = triangle();
  later.root["asset"] = {{"version", "2.7"}, {"minVersion", "2.0"}};
  CHECK(load(later).meshes.size() == 1);
}

TEST_CASE("geometry in a compression that psf lacks is refused by its name", "[load][gltf]") {
  Document d = triangle();
  d.root["meshes"][0]["primitives"][0]["extensions"] = {{"KHR_draco_mesh_compression", {{"x", 0}}}};
  CHECK(notes(load(d), "KHR_draco_mesh_compression (compressed geometry) is left out") == 1);
  d.root["accessors"][0].erase("bufferView");
  CHECK(contains(failure_of(d).message, "needs KHR_draco_mesh_compression"));
  const TempFolder folder;
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    json whole = triangle().root;
    whole["buffers"] = {{{"byteLength", 100}, {"extensions", {{name, {{"fallback", true}}}}}}};
    CHECK(contains(load_failure(folder.write("s.gltf", whole.dump())).message,
                   std::string("/buffers/0: needs ") + name));
  }
}

TEST_CASE("an error of a data URI names its kind and not its bytes", "[load][gltf]") {
  const auto with_picture = [](const std::string& uri) {
    Document d = with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    d.root["images"] = {{{"uri", uri}}};
    d.root["textures"] = {{{"source", 0}}};
    return d;
  };
  const std::string bytes(100000, 'A');
  CHECK(contains(failure_of(with_picture("data:image/png;base64," + bytes + "!")).message,
                 "/images/0/uri: a data URI of image/png: character 100001 of the data is none of "
                 "base64"));
  CHECK(contains(failure_of(with_picture("data:image/png" + bytes)).message,
                 "has no comma before its data"));
  const Scene scene = load(with_picture("data:image/x-none;base64," + bytes));
  CHECK(notes(scene, "a data URI of image/x-none") == 1);
  for (const std::string& warning : scene.warnings) CHECK(warning.size() < 400);
  // Any kind will do where the bytes are a picture, and base64 is not the only way.
  CHECK(load(with_picture("data:image/webp;base64," + kPng)).textures.size() == 1);
  CHECK(load(with_picture("data:;base64," + kPng)).textures.size() == 1);
  Document d = triangle();
  json whole = d.root;
  std::string escaped = "data:application/octet-stream,";
  for (const char c : d.buffer) {
    const auto byte = static_cast<unsigned char>(c);
    escaped += {'%', "0123456789ABCDEF"[byte / 16], "0123456789abcdef"[byte % 16]};
  }
  whole["buffers"] = {{{"byteLength", d.buffer.size()}, {"uri", escaped}}};
  const TempFolder folder;
  CHECK(load_scene(folder.write("s.gltf", whole.dump())).hash == load(d).hash);
  CHECK(contains(failure_of(with_picture("https://x.org/" + bytes + ".png")).message,
                 "psf reads no network"));
  CHECK(failure_of(with_picture("gone.png")).code == ErrorCode::io);
}

TEST_CASE("names of files are those of the disk, escaped or not", "[load][gltf]") {
  const TempFolder folder;
  const std::vector<std::pair<std::string, std::string>> names = {
      {"a%20b.bin", "a b.bin"},    {"c d.bin", "c d.bin"},          {"100%.bin", "100%.bin"},
      {"%41%.bin", "%41%.bin"},    {"e%E9.bin", "e\xE9.bin"},       {"f+g.bin", "f+g.bin"},
      {"sub\\h.bin", "sub/h.bin"}, {"\xC3\xA9.bin", "\xC3\xA9.bin"}};
  for (const auto& [uri, file] : names) {
    CAPTURE(uri);
    Document d = triangle();
    json whole = d.root;
    whole["buffers"] = {{{"byteLength", d.buffer.size()}, {"uri", uri}}};
    folder.write(file, d.buffer);
    CHECK(load_scene(folder.write("s.gltf", whole.dump())).meshes.size() == 1);
  }
  for (const char* uri : {"gone.bin", "", "%00.bin", "."}) {
    json whole = triangle().root;
    whole["buffers"] = {{{"byteLength", 1}, {"uri", uri}}};
    CHECK(contains(load_failure(folder.write("s.gltf", whole.dump())).message,
                   "s.gltf:1: /buffers/0/uri: "));
  }
  // Text that is not UTF-8 is no JSON; the place is said.
  CHECK(contains(load_failure(folder.write("s.gltf", "{\"asset\":\n {\"x\": \"\xE9\"}}")).message,
                 "s.gltf:2:"));
}

TEST_CASE("a number of the wrong type or range is an error at its place", "[load][gltf]") {
  Document d = with_material({{"pbrMetallicRoughness", json::object()}});
  d.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
  d.root["nodes"][0]["camera"] = 0;
  d.root["nodes"][0]["extensions"] = {{"KHR_lights_punctual", {{"light", 0}}}};
  d.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"}, {"spot", {}}}};
  d.root["extensions"]["KHR_lights_punctual"]["lights"][0]["spot"] = json::object();
  CHECK(failure_of(d).message.empty());
  const std::string light = "/extensions/KHR_lights_punctual/lights/0", m = "/materials/0";
  const std::string pbr = m + "/pbrMetallicRoughness", e = m + "/extensions/KHR_materials_";
  const std::vector<std::pair<std::string, json>> bad = {
      {pbr + "/roughnessFactor", 2},
      {pbr + "/roughnessFactor", "rough"},
      {pbr + "/metallicFactor", -0.5},
      {pbr + "/baseColorFactor", {1, 1, 1}},
      {pbr + "/baseColorFactor", 0.5},
      {m + "/emissiveFactor", {-1, 0, 0}},
      {m + "/doubleSided", 1},
      {m + "/alphaMode", "ADD"},
      {m + "/alphaCutoff", -1},
      {e + "ior/ior", 0.5},
      {e + "ior/ior", 11},
      {e + "emissive_strength/emissiveStrength", -1},
      {e + "transmission/transmissionFactor", "all"},
      {e + "specular/specularFactor", 2},
      {e + "specular/specularColorFactor", {1, 1}},
      {e + "pbrSpecularGlossiness/specularFactor", {2, 0, 0}},
      {e + "pbrSpecularGlossiness/glossinessFactor", -1},
      {"/cameras/0/perspective/yfov", 0},
      {"/cameras/0/perspective/yfov", 3.2},
      {"/cameras/0/perspective/aspectRatio", -1},
      {"/cameras/0/perspective/znear", -1},
      {"/cameras/0/type", "fisheye"},
      {light + "/intensity", -1},
      {light + "/color", {1, -1, 1}},
      {light + "/type", "area"},
      {light + "/range", 0},
      {light + "/spot/outerConeAngle", 2},
      {light + "/spot/innerConeAngle", 1},
      {"/nodes/0/scale", {1, 1}},
      {"/nodes/0/translation", {1e39, 0, 0}},
      {"/nodes/0/rotation", {0, 0, 0, 0}},
      {"/nodes/0/mesh", 1.5},
      {"/nodes/0/mesh", -1},
      {"/nodes/0/mesh", "0"},
      {"/nodes/0/camera", 1},
      {"/nodes/0/matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
      {"/nodes/0/extensions/KHR_lights_punctual/light", 7},
      {"/nodes/0/children", {9}},
      {"/meshes/0/primitives/0/mode", 7},
      {"/meshes/0/primitives/0/material", 3},
      {"/meshes/0/primitives/0/indices", 9},
      {"/meshes/0/primitives/0/attributes/POSITION", "0"},
      {"/accessors/0/componentType", 5124},
      {"/accessors/0/type", "VEC5"},
      {"/accessors/0/count", -3},
      {"/accessors/0/byteOffset", 0.5},
      {"/accessors/0/bufferView", 9},
      {"/bufferViews/0/byteLength", -1},
      {"/bufferViews/0/byteStride", 1},
      {"/bufferViews/0/buffer", 4},
      {"/scene", 3},
      {"/scenes/0/nodes", {5}}};
  for (const auto& [pointer, value] : bad) {
    CAPTURE(pointer, value.dump());
    Document wrong = d;
    wrong.root[json::json_pointer(pointer)] = value;
    const Failure failure = failure_of(wrong);
    CHECK(failure.code == ErrorCode::bad_input);
    CHECK(failure.message.find("s.gltf:1: " + pointer) == 0);
  }
  // The specification lets whole numbers be written so.
  Document whole = triangle();
  whole.root["nodes"][0]["mesh"] = 0.0;
  whole.root["accessors"][0]["count"] = 3.0;
  CHECK(load(whole).meshes.size() == 1);
}

}  // namespace
}  // namespace psf::render
