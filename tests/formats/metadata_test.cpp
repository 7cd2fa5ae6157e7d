// Metadata comes back whole; what is malformed is named.
#include "formats/layout/metadata.h"

#include <cmath>

#include "catch.h"
#include "core/error.h"

using namespace psf;
using namespace psf::formats;

namespace {

std::string complaint(const std::string& json) {
  try {
    static_cast<void>(parse_metadata(json));
  } catch (const Error& error) {
    // Nested too deep is a limit.
    CHECK((error.code() == ErrorCode::bad_input || error.code() == ErrorCode::limit));
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("metadata survives JSON exactly") {
  Metadata in;
  in.producer = "psf-render \"0.1\" \xC3\xA9\n";
  in.scene = "box.json";
  in.scene_hash = "00ff";
  in.integrator = "path";
  in.sampler = "sobol";
  in.enumeration = "global";
  in.seed = 0xFFFFFFFFFFFFFFFFu;
  in.block_base = 3;
  in.split = 16;
  in.shade_rate = 4;
  in.vertex_roughness = 0.1 + 0.2;
  in.vertex_rule = "first diffuse";
  in.units = "m";
  in.cameras.resize(2);
  in.cameras[1] = {"left", 1920, 1080, 1e-3 / 7, {}, {}};
  for (std::size_t k = 0; k < 16; ++k) {
    in.cameras[1].camera_to_world[k] = std::sqrt(static_cast<double>(k) + 2);
    in.cameras[1].projection[k] = -1e-300 * static_cast<double>(k);
  }
  in.lights = {"sun", "", "lamp"};
  in.visibility_rule = "of the strong ones";
  in.materials = {"", "caf\xC3\xA9", "wall"};
  const Metadata out = parse_metadata(to_json(in));
  CHECK(out.producer == in.producer);
  CHECK(out.scene == in.scene);
  CHECK(out.scene_hash == in.scene_hash);
  CHECK(out.integrator == in.integrator);
  CHECK(out.sampler == in.sampler);
  CHECK(out.enumeration == in.enumeration);
  CHECK(out.seed == in.seed);
  CHECK(out.block_base == in.block_base);
  CHECK(out.split == in.split);
  CHECK(out.shade_rate == in.shade_rate);
  CHECK(out.vertex_roughness == in.vertex_roughness);
  CHECK(out.vertex_rule == in.vertex_rule);
  CHECK(out.units == in.units);
  CHECK(out.cameras == in.cameras);
  CHECK(out.lights == in.lights);
  CHECK(out.visibility_rule == in.visibility_rule);
  CHECK(out.materials == in.materials);
  // Without names there is no key: files of earlier versions stay the same byte for byte.
  CHECK(to_json(Metadata{}).find("materials") == std::string::npos);
  CHECK(to_json(Metadata{}).find("visibility_rule") == std::string::npos);
}

TEST_CASE("the frames of a sequence and their cameras survive JSON, and what is wrong is named") {
  Metadata in;
  in.cameras = {{"left", 64, 48, 0.25, {}, {}}, {"right", 32, 16, 0.5, {}, {}}};
  CHECK(to_json(in).find("frames") == std::string::npos);
  in.frames = FrameInfo{7, 2, 5, {in.cameras, in.cameras}};
  in.frames->cameras[1][0].angle_per_pixel = 0.125;
  in.frames->cameras[1][1].camera_to_world[3] = 1.0 / 3;
  const Metadata out = parse_metadata(to_json(in));
  REQUIRE(out.frames.has_value());
  CHECK((out.frames->first == 7 && out.frames->count == 2 && out.frames->passes == 5));
  CHECK(out.frames->cameras == in.frames->cameras);

  CHECK(complaint(R"({"frames": 3})").find("/frames: expected an object") != std::string::npos);
  CHECK(complaint(R"({"frames": {"count": 0}})").find("at least 1") != std::string::npos);
  CHECK(complaint(R"({"frames": {"first": 4294967295, "count": 2}})").find("below 2^32") !=
        std::string::npos);
  CHECK(complaint(R"({"frames": {"count": 2, "cameras": [[]]}})")
            .find("/frames/cameras: expected an entry for each frame") != std::string::npos);
  CHECK(complaint(R"({"frames": {"cameras": [[{}]]}})")
            .find("/frames/cameras/0: expected all cameras of the file") != std::string::npos);
}

TEST_CASE("unknown metadata keys are ignored and missing ones keep their defaults") {
  const Metadata out = parse_metadata(R"({"new":{"deep":[1,2]},"split":4,"cameras":[{"x":1}]})");
  CHECK(out.split == 4);
  CHECK(out.block_base == 2);
  CHECK(out.cameras.size() == 1);
  CHECK(out.cameras[0].width == 0);
}

TEST_CASE("malformed metadata is an error that names the key") {
  CHECK(complaint("") != "");
  CHECK(complaint("[]") != "");
  CHECK(complaint("{\"a\":}") != "");
  CHECK(complaint("{\"producer\":\"\xFF\"}") != "");
  CHECK(complaint(std::string(100000, '[')) != "");
  CHECK(complaint("{\"a\":" + std::string(60, '[') + std::string(60, ']') + "}") == "");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"({"producer":1})", "/producer"},
      {R"({"seed":-1})", "/seed"},
      {R"({"seed":1.5})", "/seed"},
      {R"({"seed":18446744073709551616})", "/seed"},
      {R"({"split":4294967296})", "/split"},
      {R"({"block_base":"2"})", "/block_base"},
      {R"({"vertex_roughness":null})", "/vertex_roughness"},
      {R"({"cameras":{}})", "/cameras"},
      {R"({"cameras":[{},[]]})", "/cameras/1"},
      {R"({"cameras":[{"width":-3}]})", "/cameras/0/width"},
      {R"({"cameras":[{"camera_to_world":[1,2]}]})", "/cameras/0/camera_to_world"},
      {R"({"cameras":[{"projection":[0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,"x"]}]})",
       "/cameras/0/projection/15"},
      {R"({"lights":["a",2]})", "/lights/1"},
      {R"({"materials":{"1":"wall"}})", "/materials"}};
  for (const auto& [json, key] : cases) {
    CAPTURE(json);
    CHECK(complaint(json).find(key + ":") != std::string::npos);
  }
}

TEST_CASE("a MiB of keys, of cameras or of brackets is read or refused") {
  std::string keys = "{", cameras = R"({"cameras":[)";
  for (int k = 0; k < 80000; ++k) keys += "\"" + std::to_string(k) + "\":0,";
  for (int k = 0; k < 300000; ++k) cameras += "{},";
  const std::string deep = R"({"x":)" + std::string(500000, '[') + std::string(500000, ']') + "}";
  static_cast<void>(parse_metadata(keys + "\"last\":0}"));
  CHECK(parse_metadata(cameras + "{}]}").cameras.size() == 300001);
  CHECK(complaint(deep).find("within each other") != std::string::npos);
  CHECK(complaint(R"({"x":"[[[[\"]]]]"})" + std::string(70, ']')).find("expected a JSON object") !=
        std::string::npos);
  CHECK(complaint(R"({"x":")" + std::string(70, '[') + R"(\"[["})").empty());
}
