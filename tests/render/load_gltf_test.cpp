// glTF and GLB: geometry through every kind of accessor, nodes, materials, lights, cameras, and
// what is refused.
#include <numbers>

#include "catch.h"
#include "gltf_document.h"
#include "gltf_load.h"
#include "load_support.h"

namespace psf::render {
namespace {

std::string message_of(const Document& d, ErrorCode code = ErrorCode::bad_input) {
  const TempFolder folder;
  const Failure failure = load_failure(folder.write("s.gltf", d.gltf()));
  CHECK(failure.code == code);
  CHECK(!contains(failure.message, "\n"));
  return failure.message;
}

Vec3 normal_of(const Mesh& mesh) {
  const auto& [a, b, c] = mesh.triangles.at(0);
  return cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a])
      .normalized();
}

TEST_CASE("the same triangle comes from glTF and GLB, strided and indexed in every type",
          "[load][gltf]") {
  const Scene scene = load(triangle());
  REQUIRE(scene.meshes.size() == 1);
  CHECK(scene.meshes[0].name == "tri");
  check_point(scene.meshes[0].positions.at(1), {1, 0, 0});
  check_point(scene.meshes[0].positions.at(2), {0, 2, 0});
  check_point(normal_of(scene.meshes[0]), {0, 0, 1});

  const TempFolder folder;
  CHECK(load_scene(folder.write("s.glb", triangle().glb())).hash == scene.hash);

  Document bytes = triangle(), words = triangle();
  bytes.root["meshes"][0]["primitives"][0]["indices"] =
      bytes.accessor(std::vector<std::uint8_t>{0, 1, 2}, 5121, "SCALAR", 1);
  words.root["meshes"][0]["primitives"][0]["indices"] =
      words.accessor(std::vector<std::uint32_t>{0, 1, 2}, 5125, "SCALAR", 1);
  CHECK(load(bytes).hash == scene.hash);
  CHECK(load(words).hash == scene.hash);
  Document plain = triangle();
  plain.root["meshes"][0]["primitives"][0].erase("indices");
  CHECK(load(plain).hash == scene.hash);
}

TEST_CASE("buffers and pictures may lie beside the file", "[load][gltf]") {
  Document d = triangle();
  d.root["images"] = {{{"uri", "wood%20grain.ppm"}}};
  d.root["textures"] = {{{"source", 0}}};
  d.root["materials"] = {
      {{"name", "oak"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  d.root["meshes"][0]["primitives"][0]["material"] = 0;
  json whole = d.root;
  whole["buffers"] = {{{"byteLength", d.buffer.size()}, {"uri", "data.bin"}}};
  const TempFolder folder;
  const std::string path = folder.write("s.gltf", whole.dump());
  CHECK(load_failure(path).code == ErrorCode::io);
  CHECK(contains(load_failure(path).message, "s.gltf: /materials/0 (oak): base colour: image 0: "));
  folder.write("wood grain.ppm", ppm(1, "255 0 0"));
  CHECK(load_failure(path).code == ErrorCode::io);
  CHECK(load_failure(path).message ==
        "s.gltf:1: /buffers/0/uri: data.bin: cannot open: No such file or directory");
  folder.write("data.bin", d.buffer);
  const Scene scene = load_scene(path);
  CHECK(scene.textures.at(0).texel(0, 0) == Rgb(1, 0, 0));
}

TEST_CASE("pictures come from data URIs and buffer views too, colours and numbers apart",
          "[load][gltf]") {
  Document d = triangle();
  const std::string picture = decode_base64(kPng);
  d.accessor(std::vector<std::uint8_t>(picture.begin(), picture.end()), 5121, "SCALAR", 1);
  d.root["images"] = {
      {{"uri", "data:image/png;base64," + kPng}},
      {{"bufferView", d.root["bufferViews"].size() - 1}, {"mimeType", "image/png"}}};
  d.root["textures"] = {{{"source", 0}}, {{"source", 1}}};
  d.root["materials"] = {
      {{"pbrMetallicRoughness",
        {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 1}}}}}}};
  d.root["meshes"][0]["primitives"][0]["material"] = 0;
  const Scene scene = load(d);
  const Material& m = scene.materials.at(0);
  CHECK(scene.textures.at(static_cast<std::size_t>(m.reflectance_texture)).texel(0, 0).x ==
        Approx(0.5029).margin(1e-4));
  CHECK(scene.textures.at(static_cast<std::size_t>(m.roughness_metalness_texture)).texel(0, 0).x ==
        Approx(188 / 255.0));
  d.root["bufferViews"].back()["byteLength"] = 1000000;
  CHECK(contains(message_of(d), "reach outside buffer 0"));
}

TEST_CASE("emission, metalness and glass survive", "[load][gltf]") {
  Document d = triangle();
  d.root["extensionsUsed"] = {"KHR_materials_emissive_strength", "KHR_materials_transmission",
                              "KHR_materials_ior"};
  d.root["materials"] = {
      {{"name", "lamp"},
       {"emissiveFactor", {1, 0.5, 0.25}},
       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}}},
      {{"name", "brass"},
       {"doubleSided", true},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.9, 0.7, 0.3, 1}},
         {"metallicFactor", 0.75},
         {"roughnessFactor", 0.2}}}},
      {{"name", "pane"},
       {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}},
       {"extensions",
        {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
         {"KHR_materials_ior", {{"ior", 1.33}}}}}}};
  d.root["meshes"][0]["primitives"][0]["material"] = 0;
  const Scene scene = load(d);
  REQUIRE(scene.materials.size() == 3);
  CHECK(scene.materials[0].emission == Rgb(8, 4, 2));
  CHECK(!scene.materials[0].two_sided);
  CHECK(scene.materials[1].kind == MaterialKind::coat);
  CHECK(scene.materials[1].reflectance == Rgb(0.9f, 0.7f, 0.3f));
  CHECK(scene.materials[1].metalness == 0.75f);
  CHECK(scene.materials[1].roughness == 0.2f);
  CHECK(scene.materials[1].two_sided);
  CHECK(scene.materials[2].kind == MaterialKind::glass);
  CHECK(scene.materials[2].ior == Approx(1.33));
  // The default of glTF for a primitive without material.
  const Scene plain = load(triangle());
  CHECK(plain.materials.at(0).metalness == 1);
  CHECK(plain.materials.at(0).reflectance == Rgb(1));
}

TEST_CASE("nodes move, turn, scale and mirror what hangs on them", "[load][gltf]") {
  const float half = std::sqrt(0.5f);
  Document d = triangle();
  // Scale by 2, a quarter turn about z (x to y, y to -x), then 10 along x; under a parent that
  // moves 100 up.
  d.root["nodes"] = {{{"children", {1}}, {"translation", {0, 100, 0}}},
                     {{"mesh", 0},
                      {"scale", {2, 2, 2}},
                      {"rotation", {0, 0, half, half}},
                      {"translation", {10, 0, 0}}}};
  Scene scene = load(d);
  check_point(scene.meshes.at(0).positions[1], {10, 102, 0});
  check_point(scene.meshes[0].positions[2], {6, 100, 0});
  // The same as a matrix, column by column.
  d.root["nodes"][1] = {{"mesh", 0},
                        {"matrix", {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 10, 0, 0, 1}}};
  scene = load(d);
  check_point(scene.meshes.at(0).positions[1], {10, 102, 0});
  check_point(scene.meshes[0].positions[2], {6, 100, 0});
  check_point(normal_of(scene.meshes[0]), {0, 0, 1});
  // Mirrored at x = 0: the front stays in front.
  d.root["nodes"][1] = {{"mesh", 0}, {"scale", {-1, 1, 1}}};
  scene = load(d);
  // So far away for its size, it has a space of its own.
  check_point(Vec3(scene.space.world(scene.meshes.at(0).positions[1])), {-1, 100, 0});
  check_point(normal_of(scene.meshes[0]), {0, 0, 1});
  d.root["nodes"][1]["children"] = {0};
  CHECK(contains(message_of(d), "node 0 is in the scene twice"));
}

TEST_CASE("cameras and lights of the file arrive where their nodes put them", "[load][gltf]") {
  const float half = std::sqrt(0.5f);
  Document d = triangle();
  d.root["extensionsUsed"] = {"KHR_lights_punctual"};
  d.root["extensions"] = {
      {"KHR_lights_punctual",
       {{"lights",
         {{{"type", "point"}, {"name", "bulb"}, {"color", {1, 0.5, 0.25}}, {"intensity", 40}},
          {{"type", "directional"}, {"intensity", 3}},
          {{"type", "spot"},
           {"intensity", 2},
           {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.5}}}}}}}}};
  d.root["cameras"] = {{{"type", "perspective"},
                        {"perspective", {{"yfov", 1.0}, {"aspectRatio", 2.0}, {"znear", 0.1}}}}};
  d.root["scenes"][0]["nodes"] = {0, 1, 2, 3, 4};
  const auto light = [](int index) { return json{{"KHR_lights_punctual", {{"light", index}}}}; };
  d.root["nodes"] = {{{"mesh", 0}},
                     {{"camera", 0}, {"name", "eye"}, {"translation", {0, 0, 9}}},
                     {{"extensions", light(0)}, {"translation", {1, 2, 3}}},
                     // A quarter turn about x takes y to z, so -z to y.
                     {{"extensions", light(1)}, {"rotation", {half, 0, 0, half}}},
                     {{"extensions", light(2)}}};
  const Scene scene = load(d);
  REQUIRE(scene.cameras.size() == 1);
  const Camera& camera = scene.cameras[0];
  check_point(camera.eye, {0, 0, 9});
  check_point((camera.target - camera.eye).normalized(), {0, 0, -1});
  CHECK(camera.fov == Approx(2 * std::atan(2 * std::tan(0.5))));
  CHECK((camera.width == 512 && camera.height == 256));
  REQUIRE(scene.lights.size() == 3);
  CHECK(scene.lights[0].kind == LightKind::point);
  CHECK(scene.lights[0].name == "bulb");
  CHECK(scene.lights[0].intensity == Rgb(40, 20, 10));
  check_point(scene.lights[0].position, {1, 2, 3});
  CHECK(scene.lights[1].kind == LightKind::directional);
  check_point(scene.lights[1].direction, {0, 1, 0});
  CHECK(scene.lights[2].kind == LightKind::spot);
  CHECK(scene.lights[2].cos_inner == Approx(std::cos(0.1)));
  CHECK(scene.lights[2].cos_outer == Approx(std::cos(0.5)));
}

TEST_CASE("strips, fans, sparse accessors, normalised coordinates and texture transforms",
          "[load][gltf]") {
  Document d = triangle();
  const int square =
      d.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, 5126, "VEC3", 3);
  const int uvs =
      d.accessor(std::vector<std::uint8_t>{0, 0, 255, 0, 0, 255, 255, 255}, 5121, "VEC2", 2);
  d.root["accessors"][static_cast<std::size_t>(uvs)]["normalized"] = true;
  auto& primitive = d.root["meshes"][0]["primitives"][0];
  primitive = {{"attributes", {{"POSITION", square}, {"TEXCOORD_0", uvs}}}, {"mode", 5}};
  Scene scene = load(d);
  REQUIRE(scene.meshes.at(0).triangles.size() == 2);
  for (const auto& [a, b, c] : scene.meshes[0].triangles) {
    const auto& p = scene.meshes[0].positions;
    check_point(cross(p[b] - p[a], p[c] - p[a]), {0, 0, 1});
  }
  // glTF's v goes down, ours up.
  CHECK(scene.meshes[0].uvs[0] == Vec2(0, 1));
  CHECK(scene.meshes[0].uvs[3] == Vec2(1, 0));

  const int where = d.accessor(std::vector<std::uint16_t>{2}, 5123, "SCALAR", 1);
  const int what = d.accessor(std::vector<float>{7, 8, 9}, 5126, "VEC3", 3);
  const auto view_of = [&](int accessor) {
    return d.root["accessors"][static_cast<std::size_t>(accessor)]["bufferView"];
  };
  d.root["accessors"][static_cast<std::size_t>(square)]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", view_of(where)}, {"byteOffset", 0}, {"componentType", 5123}}},
      {"values", {{"bufferView", view_of(what)}, {"byteOffset", 0}}}};
  scene = load(d);
  check_point(scene.meshes.at(0).positions[1], {1, 0, 0});
  check_point(scene.meshes[0].positions[2], {7, 8, 9});

  d.root["images"] = {{{"uri", "data:image/png;base64," + kPng}}};
  d.root["textures"] = {{{"source", 0}}};
  d.root["materials"] = {
      {{"pbrMetallicRoughness",
        {{"baseColorTexture",
          {{"index", 0},
           {"extensions",
            {{"KHR_texture_transform", {{"scale", {2, 4}}, {"offset", {0.5, 0.25}}}}}}}}}}}};
  primitive["material"] = 0;
  scene = load(d);
  CHECK(scene.meshes.at(0).uvs[0] == Vec2(0.5f, 0.75f));
  CHECK(scene.meshes[0].uvs[3] == Vec2(2.5f, -3.25f));
}

TEST_CASE("what a node flattens is there, with the normals of its faces", "[load][gltf]") {
  Document d = triangle();
  d.root["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
      d.accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}, 5126, "VEC3", 3);
  d.root["nodes"][0]["scale"] = {3, 1, 0};
  const Scene scene = load(d);
  CHECK(scene.meshes.at(0).normals.empty());
  check_point(scene.meshes[0].positions.at(1), {3, 0, 0});
  check_point(normal_of(scene.meshes[0]), {0, 0, 1});
}

TEST_CASE("nodes within nodes are a tree, and no deeper than 512", "[load][gltf]") {
  // With two ways to each, 40 levels would be 2^40 meshes.
  Document d = triangle();
  json nodes = json::array();
  for (int k = 0; k < 40; ++k) nodes.push_back({{"children", {k + 1, k + 1}}});
  nodes.push_back({{"mesh", 0}});
  d.root["nodes"] = nodes;
  d.root["scenes"] = {{{"nodes", {0}}}};
  CHECK(message_of(d) ==
        "s.gltf:1: /nodes/39/children/1: node 40 is in the scene twice; glTF has a tree of nodes, "
        "copy it");
  nodes = json::array();
  for (int k = 0; k < 600; ++k) nodes.push_back({{"children", {k + 1}}});
  nodes.push_back({{"mesh", 0}});
  d.root["nodes"] = nodes;
  CHECK(contains(message_of(d), "more than 512 nodes within nodes"));
}

TEST_CASE("an error of a glTF file names the place in it", "[load][gltf]") {
  Document d = triangle();
  d.root["accessors"][0]["count"] = 1000;
  CHECK(message_of(d) ==
        "s.gltf:1: /accessors/0: 1000 elements do not fit into the 60 bytes of bufferView 0");
  d = triangle();
  d.root["accessors"][0]["count"] = 4000000000u;
  d.root["accessors"][0].erase("bufferView");
  CHECK(contains(message_of(d, ErrorCode::limit),
                 "elements without bufferView are more than psf takes"));
  d.root["accessors"][0]["count"] = (1 << 24) + 1;
  CHECK(contains(message_of(d, ErrorCode::limit), "s.gltf:1: /accessors/0: 16777217 elements"));
  d = triangle();
  d.root["meshes"][0]["primitives"][0]["indices"] =
      d.accessor(std::vector<std::uint32_t>{0, 1, 3}, 5125, "SCALAR", 1);
  CHECK(message_of(d) == "s.gltf: mesh tri: triangle 0 names vertex 3, there are 3");
  d = triangle();
  d.root["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
      d.accessor(std::vector<float>{0, 0, 0, 1, std::nanf(""), 0, 0, 1, 0}, 5126, "VEC3", 3);
  CHECK(message_of(d) == "s.gltf: mesh tri: vertex 1 is not finite");
  d = triangle();
  d.root["nodes"][0]["mesh"] = 5;
  CHECK(message_of(d) == "s.gltf:1: /nodes/0/mesh: there is no mesh 5");
  d = triangle();
  const std::size_t indices = d.root["meshes"][0]["primitives"][0]["indices"];
  d.root["accessors"][indices]["normalized"] = true;
  CHECK(contains(message_of(d), "is normalized, which indices are not"));
  d = triangle();
  d.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  CHECK(
      message_of(d) ==
      "s.gltf: /extensionsRequired: the file needs KHR_draco_mesh_compression, which psf does not "
      "have; export it without");
  d = triangle();
  d.root["materials"] = {
      {{"name", "bright"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1.5, 1, 1}}}}}};
  CHECK(
      message_of(d) ==
      "s.gltf:1: /materials/0/pbrMetallicRoughness/baseColorFactor/1: expected a number in [0, 1], "
      "got 1.5");
}

TEST_CASE("damaged glTF and GLB files are errors, cut anywhere", "[load][gltf]") {
  const TempFolder folder;
  CHECK(contains(load_failure(folder.write("s.gltf", "{\n \"asset\": ,")).message,
                 "s.gltf:2:11: malformed JSON"));
  CHECK(load_failure(folder.write("s.gltf", "")).code == ErrorCode::bad_input);
  for (const bool binary : {false, true}) {
    const std::string whole = binary ? triangle().glb() : triangle().gltf();
    const std::string name = binary ? "s.glb" : "s.gltf";
    for (std::size_t length = 0; length < whole.size(); length += 5) {
      CHECK(load_failure(folder.write(name, whole.substr(0, length))).code == ErrorCode::bad_input);
    }
  }
}

}  // namespace
}  // namespace psf::render
