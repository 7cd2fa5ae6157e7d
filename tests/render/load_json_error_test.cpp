// The JSON scene file: where each error says it is.
#include <fmt/format.h>
#include <sys/stat.h>

#include "catch.h"
#include "load_support.h"

namespace psf::render {
namespace {

std::string message_of(const std::string& text, ErrorCode code = ErrorCode::bad_input) {
  const TempFolder folder;
  const Failure failure = load_failure(folder.write("s.json", text));
  CHECK(failure.code == code);
  CHECK(!contains(failure.message, "\n"));
  return failure.message;
}

TEST_CASE("an error of the JSON scene names the line of the value", "[load][json]") {
  const auto at = [](int line, const std::string& path, const std::string& text) {
    const std::string message = message_of(text);
    INFO(message);
    CHECK(message.starts_with(fmt::format("s.json:{}: {}: ", line, path)));
  };
  const std::string lights = "{\n\"lights\": [\n{\"kind\": \"point\",\n";
  at(5, "/lights/0/position/1", lights + "\"position\": [0,\n\"a\"\n, 0]}\n]}");
  at(4, "/lights/0/intensity", lights + "\"position\": [0, 0, 0], \"intensity\": -1\n}\n]}");
  at(5, "/lights/0/intensity", lights + "\"position\": [0, 0,\n 0], \"intensity\": -1}]}");
  at(5, "/lights/0/intensity/2",
     lights +
         "\"comment\": [[], {\"intensity\": 2}], \"position\": [0, 0, 0],"
         "\"intensity\": [1,\n1,-1\n]}]}");
  at(3, "/lights/0", lights + "\"\\u0061\": 1}]}");
  at(2, "/environment", "{\"lights\": [], \n\"environment\": true\n\n}");
}

TEST_CASE("an error of the JSON scene names file and JSON path", "[load][json]") {
  CHECK(message_of(
            R"({"materials": [{"name": "a"}, {"name": "b"}, {"name": "c",
              "roughness": "shiny"}]})") ==
        "s.json:2: /materials/2/roughness: expected a number in [0, 1], got \"shiny\"");
  CHECK(message_of(R"({"materials": [{"name": "a", "rougness": 0.5}]})") ==
        "s.json:1: /materials/0: unknown key \"rougness\"; did you mean \"roughness\"?");
  CHECK(message_of(R"({"camera": []})") ==
        "s.json:1: /: unknown key \"camera\"; did you mean \"cameras\"?");
  CHECK(message_of(R"({"materials": [{"name": "a", "qqqqqqqq": 1}]})") ==
        "s.json:1: /materials/0: unknown key \"qqqqqqqq\"");
  CHECK(message_of(R"({"materials": [{"name": "a", "reflectance": [0.5, 1.5, 0.5]}]})") ==
        "s.json:1: /materials/0/reflectance/1: expected a number in [0, 1], got 1.5");
  CHECK(message_of(R"({"materials": [{"name": "a", "kind": "velvet"}]})") ==
        "s.json:1: /materials/0/kind: expected one of diffuse, mirror, glass, conductor, coat, "
        "subsurface, volume, got \"velvet\"");
  CHECK(message_of(R"({"materials": [{"name": "a"}, {"name": "a"}]})") ==
        "s.json:1: /materials/1/name: another material is called \"a\"");
  CHECK(message_of(R"({"materials": [{"kind": "glass"}]})") ==
        "s.json:1: /materials/0: the key \"name\" is missing");
  CHECK(message_of(with_shapes(
            R"({"shape": "sphere", "material": "whit", "center": [0,0,0], "radius": 1})")) ==
        "s.json:2: /shapes/0/material: no material is called \"whit\"; did you mean \"white\"?");
  CHECK(message_of(with_shapes(
            R"({"shape": "sphere", "material": "white", "center": [0,0], "radius": 1})")) ==
        "s.json:2: /shapes/0/center: expected an array of 3 numbers, got [0,0]");
  CHECK(message_of(with_shapes(
            R"({"shape": "sphere", "material": "white", "center": [0,0,0], "radius": 0})")) ==
        "s.json:2: /shapes/0/radius: expected a number > 0, got 0");
  CHECK(
      message_of(
          with_shapes(R"({"shape": "sphere", "material": "white", "center": [0,0,0], "radius": 1,
                                   "transform": {"scale": [1, 2, 1]}})")) ==
      "s.json:2: /shapes/0: a sphere can be moved, turned and scaled evenly only; use a lathe for "
      "an ellipsoid");
  CHECK(
      message_of(with_shapes(R"({"shape": "group", "shapes": [{"shape": "box", "material": "white",
                                   "min": [0,0,0], "max": [1,0,1]}]})")) ==
      "s.json:2: /shapes/0/shapes/0: \"min\" is not below \"max\" in each of x, y and z");
  CHECK(message_of(with_shapes(
            R"({"shape": "mesh", "material": "white", "positions": [[0,0,0],[1,0,0],[0,1,0]],
                                   "triangles": [[0, 1, 3]]})")) ==
        "s.json:3: /shapes/0/triangles/0/2: expected a whole number from 0 to 2, got 3");
  CHECK(message_of(
            with_shapes(R"({"shape": "quad", "material": "white", "origin": [0,0,0], "u": [1,0,0],
                                   "v": [0,1,0], "transform": [{"rotate": 5, "axis": "w"}]})")) ==
        "s.json:3: /shapes/0/transform/0/axis: expected one of x, y, z, got \"w\"");
  CHECK(message_of(R"({"cameras": [{"eye": [0,0,1], "target": [0,0,0], "fov": 180}]})") ==
        "s.json:1: /cameras/0/fov: expected a number of degrees in (0, 180), got 180");
  CHECK(message_of(R"({"cameras": [{"eye": [0,0,1], "target": [0,0,0], "size": [0, 10]}]})") ==
        "s.json:1: /cameras/0/size/0: expected a whole number from 1 to 65535, got 0");
  CHECK(message_of(R"({"lights": [{"kind": "point", "position": [0,0,0], "intensity": -1}]})") ==
        "s.json:1: /lights/0/intensity: expected a number >= 0, got -1");
  CHECK(message_of("[1, 2]") == "s.json:1: /: expected an object, got [1,2]");
}

TEST_CASE("an error of a medium of the JSON scene names file and JSON path", "[load][json]") {
  const auto medium = [](const std::string& keys) {
    return message_of(R"({"media": [{"name": "wax")" + keys + "}]}");
  };
  CHECK(medium("") ==
        "s.json:1: /media/0: \"albedo\" and \"mean_free_path\" are missing, or \"sigma_a\" and "
        "\"sigma_s\"");
  CHECK(medium(R"(, "albedo": 1)") == "s.json:1: /media/0: the key \"mean_free_path\" is missing");
  CHECK(medium(R"(, "albedo": 1, "mean_free_path": 0)") ==
        "s.json:1: /media/0/mean_free_path: expected a number > 0, got 0");
  CHECK(medium(R"(, "albedo": 1, "mean_free_path": 1, "sigma_s": 1)") ==
        "s.json:1: /media/0: has \"albedo\" or \"mean_free_path\" and \"sigma_a\" or \"sigma_s\", "
        "one of both pairs is enough");
  CHECK(medium(R"(, "sigma_s": 1, "g": 1)") ==
        "s.json:1: /media/0/g: expected a number in [-0.99, 0.99], got 1");
  const auto density = [&](const std::string& keys) {
    return medium(R"(, "sigma_s": 1, "density": {)" + keys + "}");
  };
  CHECK(density("") == "s.json:1: /media/0/density: the key \"kind\" is missing");
  CHECK(density(R"("kind": "clod")") ==
        "s.json:1: /media/0/density/kind: expected one of cloud, mist, grid, got \"clod\"");
  CHECK(density(R"("kind": "cloud", "min": [0, 0, 0])").substr(0, 42) ==
        "s.json:1: /media/0/density: unknown key \"m");
  CHECK(density(R"("kind": "cloud", "voxels": 0)") ==
        "s.json:1: /media/0/density/voxels: expected a whole number from 1 to 1024, got 0");
  CHECK(density(R"("kind": "cloud", "repeat": {"count": 2, "step": {"scale": 1}})") ==
        "s.json:1: /media/0/density/repeat: a density stands still, and alone");
  CHECK(density(R"("kind": "mist", "min": [0, 0, 0], "max": [1, 0, 1])") ==
        "s.json:1: /media/0/density/max: is not greater than \"min\" along each axis");
  const std::string flat = "[1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]";
  CHECK(density(R"("kind": "cloud", "transform": {"matrix": )" + flat + "}") ==
        "s.json:1: /media/0/density/transform: makes everything flat");
  CHECK(message_of(R"({"media": [{"name": "a", "sigma_s": 1}, {"name": "a", "sigma_s": 1}]})") ==
        "s.json:1: /media/1/name: another medium is called \"a\"");
  const auto material = [](const std::string& keys) {
    return message_of(R"({"media": [{"name": "wax", "sigma_s": 1}], "materials": [{"name": "m")" +
                      keys + "}]}");
  };
  CHECK(material(R"(, "kind": "subsurface")") ==
        "s.json:1: /materials/0: the key \"interior\" is missing");
  CHECK(material(R"(, "kind": "subsurface", "interior": "waxx")") ==
        "s.json:1: /materials/0/interior: no medium is called \"waxx\"; did you mean \"wax\"?");
  CHECK(message_of(R"({"media": [{"name": "wax", "sigma_s": 1}], "medium": "wx"})") ==
        "s.json:1: /medium: no medium is called \"wx\"; did you mean \"wax\"?");
  CHECK(material(R"(, "kind": "volume", "interior": "wax", "opacity": 0.5)") ==
        "s.json:1: /materials/0/opacity: materials with an interior are never there in part; leave "
        "it out");
  for (const std::string key : {"emission", "emission_map"}) {
    CHECK(material(R"(, "kind": "volume", "interior": "wax", ")" + key + R"(": 1)") ==
          "s.json:1: /materials/0/" + key +
              ": the surface of a volume is not seen, so it has no light; put a lamp into it");
  }
  CHECK(material(R"(, "interior": "wax")") ==
        "s.json:1: /materials/0/interior: only materials of the kinds subsurface and volume "
        "have one");
}

TEST_CASE("keys of a material that would do nothing are errors", "[load][json]") {
  const auto material = [](const std::string& keys) {
    return message_of(R"({"materials": [{"name": "m")" + keys + "}]}");
  };
  const std::string at = "s.json:1: /materials/0/";
  CHECK(material(R"(, "normal_scale": 2)") ==
        at + "normal_scale: does nothing without \"normal_map\"; add one, or leave it out");
  CHECK(material(R"(, "bump_height": 0.1)") ==
        at + "bump_height: does nothing without \"bump_map\"; add one, or leave it out");
  CHECK(material(R"(, "kind": "coat", "clearcoat_roughness": 0.1)") ==
        at + "clearcoat_roughness: does nothing without \"clearcoat\"; add one, or leave it out");
  CHECK(
      material(R"(, "kind": "coat", "clearcoat_roughness_map": "c.png")") ==
      at + "clearcoat_roughness_map: does nothing without \"clearcoat\"; add one, or leave it out");
  for (const std::string key : {"clearcoat", "clearcoat_roughness"}) {
    CHECK(material(R"(, "kind": "conductor", ")" + key + R"(": 0.5)") ==
          at + key + ": only materials of the kind coat have a clear coat; leave it out");
  }
  CHECK(material(R"(, "kind": "coat", "clearcoat": 2)") ==
        at + "clearcoat: expected a number in [0, 1], got 2");
}

TEST_CASE("values within values end somewhere", "[load][json]") {
  const auto nested = [](std::size_t depth) {
    return "{\"shapes\":\n" + std::string(depth, '[') + std::string(depth, ']') + "}";
  };
  CHECK(message_of(nested(400)) == "s.json:2: /shapes/0: expected an object, got an array");
  CHECK(contains(message_of(nested(100'000)), "s.json:2:"));
  CHECK(contains(message_of(nested(100'000)), "more than 512 values within values"));
}

TEST_CASE("a scene is a regular file, and so is what it names", "[load][json]") {
  const TempFolder folder;
  const std::string pipe = folder.write("pipe.json", "");
  std::filesystem::remove(pipe);
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  CHECK(load_failure(pipe).code == ErrorCode::io);
  CHECK(contains(load_failure(pipe).message, "pipe.json: is no regular file"));
  for (const char* name : {"m.gltf", "m.glb", "m.obj"}) {
    std::filesystem::create_directory(std::filesystem::path(pipe).parent_path() / name);
    const Failure failure = load_failure(folder.write(
        "s.json", with_shapes(std::string(R"({"shape": "mesh", "file": ")") + name + "\"}")));
    CHECK(failure.code == ErrorCode::io);
    CHECK(failure.message ==
          std::string("s.json:2: /shapes/0/file: ") + name + ": is a folder, a file is needed");
  }
}

TEST_CASE("malformed JSON is named with line and column", "[load][json]") {
  CHECK(contains(message_of("{\n  \"materials\": [\n    }\n"), "s.json:3:5: malformed JSON: "));
  CHECK(contains(message_of("{\"a\": 1"), "s.json:1:8: malformed JSON: "));
  CHECK(contains(message_of(""), "s.json:1:1: malformed JSON: "));
  CHECK(contains(message_of("{\n\"a\": 1e999}"), "s.json:2:6: malformed JSON: number overflow"));
  CHECK(contains(message_of("{\n\"caf\xE9\": 1}"), "s.json:2:6: malformed JSON: "));
  CHECK(message_of(R"({"materials": [{"name": "a", "name": "b"}]})") ==
        "s.json:1:35: the key \"name\" is twice in one object");
}

TEST_CASE("a texture that is not there names the material that wants it", "[load][json]") {
  const std::string message = message_of(
      R"({"materials": [{"name": "oak", "reflectance_map": "wood.png"}]})", ErrorCode::io);
  CHECK(message ==
        "s.json:1: /materials/0/reflectance_map: material \"oak\": wood.png: no such picture");
  CHECK(message_of(R"({"environment": {"map": "sky.exr"}})", ErrorCode::io) ==
        "s.json:1: /environment/map: sky.exr: no such picture");
  CHECK(message_of(with_shapes(R"({"shape": "mesh", "file": "bunny.obj"})"), ErrorCode::io) ==
        "s.json:2: /shapes/0/file: bunny.obj: cannot open: No such file or directory");
  CHECK(message_of(with_shapes(R"({"shape": "mesh", "file": "bunny.ply"})")) ==
        "s.json:2: /shapes/0/file: bunny.ply: not a kind of mesh file that psf reads (.obj, .gltf, "
        ".glb)");
}

TEST_CASE("more copies than memory are a limit, told before any is made", "[load][json]") {
  const std::string grid = R"("repeat": [{"count": 4000, "step": {"translate": [1,0,0]}},
                                         {"count": 4000, "step": {"translate": [0,1,0]}}])";
  CHECK(contains(
      message_of(
          with_shapes(
              R"({"shape": "sphere", "material": "white", "center": [0,0,0], "radius": 1, )" +
              grid + "}"),
          ErrorCode::limit),
      "s.json:3: /shapes/0/repeat/1/count: 4000 copies of 4000 are more than psf takes"));
  CHECK(contains(
      message_of(
          with_shapes(R"({"shape": "cylinder", "material": "white", "from": [0,0,0], "to": [0,1,0],
                                            "radius": 1, "segments": 65536,
                                                "repeat": {"count": 4000000,
                                            "step": {"translate": [1,0,0]}}})"),
          ErrorCode::limit),
      "are more than psf takes"));
}

}  // namespace
}  // namespace psf::render
