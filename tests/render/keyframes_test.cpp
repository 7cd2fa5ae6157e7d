// What the keyframes of scene files say of where shapes and cameras are, and what is refused.
#include <cmath>
#include <numbers>

#include "gltf_load.h"
#include "moving_scene.h"

namespace psf::render {
namespace {

Scene keyed_scene(const std::string& text, double frame = 0) {
  const TempFolder folder;
  return load_scene(folder.write("s.json", text), {}, {frame}, true);
}

const std::string kKeyedMove = R"(, "keyframes": [{"frame": 2, "translate": [1, 0, 0]},
    {"frame": 6, "translate": [3, 4, 0], "easing": "step"},
    {"frame": 10, "translate": [0, 0, 8], "easing": "smooth"},
    {"frame": 14, "translate": [0, 0, 16]}])";

Vec3 keyed_corner(const std::string& keys, double frame) {
  return keyed_scene(moving_scene(keys), frame).meshes[0].positions[0];
}

}  // namespace

TEST_CASE("A keyed shape goes straight, waits or eases from key to key, and stays at the ends") {
  const Vec3 at(-0.5f, -0.5f, -2);
  check_point(keyed_corner(kKeyedMove, -3), at + Vec3(1, 0, 0));
  check_point(keyed_corner(kKeyedMove, 2), at + Vec3(1, 0, 0));
  check_point(keyed_corner(kKeyedMove, 3), at + Vec3(1.5f, 1, 0));
  check_point(keyed_corner(kKeyedMove, 6), at + Vec3(3, 4, 0));
  check_point(keyed_corner(kKeyedMove, 9.5), at + Vec3(3, 4, 0));
  check_point(keyed_corner(kKeyedMove, 11), at + Vec3(0, 0, 8 + 8 * (3 / 16.0f - 2 / 64.0f)));
  check_point(keyed_corner(kKeyedMove, 99), at + Vec3(0, 0, 16));
}

TEST_CASE("Keys scale, then turn the short way, then move; the shape's transform comes before") {
  const std::string keys = R"(, "transform": {"translate": [0.5, 0.5, 2]}, "keyframes": [
      {"frame": 0, "scale": 1}, {"frame": 4, "scale": [3, 1, 1], "rotate": 120, "axis": "z",
      "translate": [0, 0, -5]}])";
  // The second corner begins at (1, 0, 0).
  const Vec3 half = keyed_scene(moving_scene(keys), 2).meshes[0].positions[1];
  const auto turned = static_cast<float>(std::numbers::pi / 3);
  check_point(half, {2 * std::cos(turned), 2 * std::sin(turned), -2.5f});
  // All copies move as the first does.
  const std::string copies =
      kKeyedMove + R"(, "repeat": {"count": 2, "step": {"translate": [0, 9, 0]}})";
  const Scene scene = keyed_scene(moving_scene(copies), 3);
  check_point(scene.meshes[0].positions[4] - scene.meshes[0].positions[0], {0, 9, 0});
  check_point(scene.meshes[0].positions[0], {1, 0.5f, -2});
}

TEST_CASE("A keyed camera moves in straight lines, and what a key leaves out stays") {
  const std::string keys = R"(, "keyframes": [{"frame": 0}, {"frame": 4, "eye": [0, 2, 4],
      "fov": 93.13010235415598}, {"frame": 6, "target": [4, 0, -1], "focus_distance": 9}])";
  const Camera middle = keyed_scene(moving_scene("", keys), 2).cameras[0];
  check_point(middle.eye, {0, 1, 2});
  check_point(middle.target, {0, 0, -1});
  CHECK(double{middle.fov} * 180 / std::numbers::pi == Approx(73.1301));
  const Camera later = keyed_scene(moving_scene("", keys), 5).cameras[0];
  check_point(later.eye, {0, 2, 4});
  check_point(later.target, {2, 0, -1});
  const std::string follows = R"(, "keyframes": [{"frame": 0, "eye": [0, 0, 2]}])";
  CHECK(keyed_scene(moving_scene("", follows)).cameras[0].focus_distance == 3);
}

TEST_CASE("What moves has its rest positions, those of frame 0") {
  const std::string other = R"(, {"shape": "sphere", "material": "white", "center": [0, 0, -9],
      "radius": 1, "keyframes": [{"frame": 0}, {"frame": 8, "translate": [8, 0, 0], "scale": 2}]},
      {"shape": "sphere", "material": "white", "center": [0, 0, 9], "radius": 1})";
  const Scene scene = keyed_scene(moving_scene(kKeyedMove, "", other), 4);
  REQUIRE(scene.meshes[0].rest.size() == 4);
  check_point(scene.meshes[0].rest[0], {0.5f, -0.5f, -2});
  check_point(scene.meshes[0].positions[0], {1.5f, 1.5f, -2});
  REQUIRE(scene.spheres[0].rest.has_value());
  CHECK(scene.spheres[0].rest->radius == 1);
  check_point(scene.spheres[0].rest->center, {0, 0, -9});
  CHECK(scene.spheres[0].radius == Approx(1.5f));
  CHECK_FALSE(scene.spheres[1].rest.has_value());
}

TEST_CASE(
    "The hash tells scenes that move otherwise apart, even where a frame shows no difference") {
  const auto hash = [](const std::string& keys, double frame) {
    return keyed_scene(moving_scene(keys), frame).hash;
  };
  const std::string still = R"(, "keyframes": [{"frame": 0}])";
  const std::string away = R"(, "keyframes": [{"frame": 0}, {"frame": 5, "translate": [1, 0, 0]}])";
  CHECK(hash(still, 0) != hash(away, 0));
  CHECK(hash(away, 0) != hash(away, 1));
  CHECK(hash("", 0) == hash("", 7));
}

TEST_CASE("A shape that is not there at all moments is an error that says what it is needed for") {
  Document d = triangle();
  const int times = d.accessor(std::vector<float>{0, 1}, 5126, "SCALAR", 1);
  const int scales = d.accessor(std::vector<float>{1, 1, 1, 0, 0, 0}, 5126, "VEC3", 3);
  d.root["animations"] = {
      {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}}},
       {"samplers", {{{"input", times}, {"output", scales}}}}}};
  const TempFolder folder;
  const std::string path = folder.write("s.gltf", d.gltf());
  SceneOverrides open;
  open.shutter = Shutter{0, 1};
  CHECK(load_failure(path, open, {0, 1}).message ==
        "s.gltf: some of its shapes are not there at frame 1, so they have no motion; scale none "
        "to nothing, or close the shutter");
  CHECK(load_failure(path, {}, {1, 1}, true).message ==
        "s.gltf: some of its shapes are not there at frame 1, so they have no rest positions; "
        "scale none to nothing, or leave the channel rest_position out");
}

TEST_CASE("What leaves all bounds while the shutter is open is refused, meshes and spheres") {
  const TempFolder folder;
  const std::string far =
      R"(, "keyframes": [{"frame": 0}, {"frame": 1, "translate": [1e30, 0, 0]}])";
  const std::string ball = R"(, {"shape": "sphere", "name": "ball", "material": "white",
      "center": [0, 0, -3], "radius": 1)" +
                           far + "}";
  const std::string open = R"(, "shutter": [0, 1])";
  for (const std::string& text : {moving_scene(far, open), moving_scene("", open, ball)}) {
    const std::string message = load_failure(folder.write("s.json", text)).message;
    CHECK(contains(message, "it moves out of all bounds, so it has no motion; close the shutter"));
  }
}

TEST_CASE("Errors of keyframes and shutters name the place") {
  const auto failure = [](const std::string& square, const std::string& camera = "") {
    const TempFolder folder;
    return load_failure(folder.write("s.json", moving_scene(square, camera))).message;
  };
  CHECK(
      contains(failure(R"(, "keyframes": [])"), "/shapes/0/keyframes: expected at least one key"));
  CHECK(contains(failure(R"(, "keyframes": [{"frame": 1}, {"frame": 1}])"),
                 "/shapes/0/keyframes/1/frame: the frames of keys must grow from key to key"));
  CHECK(contains(failure(R"(, "keyframes": [{"translate": [0, 0, 0]}])"), "\"frame\""));
  CHECK(contains(failure(R"(, "keyframes": [{"frame": 1, "scale": 0}])"), "scales above 0"));
  CHECK(contains(failure(R"(, "keyframes": [{"frame": 1, "rotate": 9}])"), "axis"));
  CHECK(contains(failure(R"(, "keyframes": [{"frame": 1, "easing": "soft"}])"), "easing"));
  CHECK(contains(failure("", R"(, "keyframes": [{"frame": 1, "up": [0, 0, -1]}])"), "up"));
  CHECK(contains(failure("", R"(, "shutter": [0.5, 0.2])"), "closes before it opens"));
  CHECK(contains(failure("", R"(, "shutter": [0, 2])"), "in [-1, 1]"));
}

TEST_CASE("Nodes of glTF move as their animation says, by steps, lines and splines") {
  const auto moved = [](const char* kind, const std::vector<float>& values, double frame,
                        const char* path = "translation", const char* type = "VEC3") {
    Document d = triangle();
    const int times = d.accessor(std::vector<float>{1, 3}, 5126, "SCALAR", 1);
    const int output = d.accessor(values, 5126, type, std::string(type) == "VEC3" ? 3 : 4);
    d.root["animations"] = {
        {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}},
         {"samplers", {{{"input", times}, {"output", output}, {"interpolation", kind}}}}}};
    const TempFolder folder;
    // 10 frames a second: the keys are at frames 10 and 30.
    const Scene scene = load_scene(folder.write("s.gltf", d.gltf()), {}, {frame, 10});
    return scene.meshes[0].positions[1];  // (1, 0, 0) where nothing moves
  };
  const std::vector<float> two = {1, 0, 0, 3, 0, 4};
  check_point(moved("LINEAR", two, 0), {2, 0, 0});
  check_point(moved("LINEAR", two, 15), {2.5f, 0, 1});
  check_point(moved("STEP", two, 29), {2, 0, 0});
  check_point(moved("LINEAR", two, 50), {4, 0, 4});
  // Hermite: at the middle (a + b) / 2 + span (m_a - m_b) / 8, the span 2 s.
  const std::vector<float> spline = {0, 0, 0, 1, 0, 0, 0, 8, 0, 0, -4, 0, 3, 0, 0, 0, 0, 0};
  check_point(moved("CUBICSPLINE", spline, 20), {3, 3, 0});
  const float r = std::sqrt(0.5f);  // a quarter turn about z
  const std::vector<float> turn = {0, 0, 0, 1, 0, 0, r, r};
  check_point(moved("LINEAR", turn, 20, "rotation", "VEC4"), {r, r, 0});
}

TEST_CASE("What glTF animates beside nodes is left out with a note, and bad keys are errors") {
  const auto with = [](const json& target, const std::vector<float>& times) {
    Document d = triangle();
    const int input = d.accessor(times, 5126, "SCALAR", 1);
    const int output = d.accessor(std::vector<float>{0, 0, 0, 1, 1, 1}, 5126, "VEC3", 3);
    d.root["animations"] = {{{"channels", {{{"sampler", 0}, {"target", target}}}},
                             {"samplers", {{{"input", input}, {"output", output}}}}}};
    return d;
  };
  const json node = {{"node", 0}, {"path", "translation"}};
  CHECK(load(with(node, {0, 1})).warnings.size() == 1);  // that nothing gives light
  CHECK(notes(load(with({{"node", 0}, {"path", "weights"}}, {0, 1})), "morph targets") == 1);
  CHECK(notes(load(with({{"path", "pointer"}}, {0, 1})), "other things than nodes") == 1);
  CHECK(contains(failure_of(with(node, {1, 1})).message, "grow from key to key"));
  CHECK(contains(failure_of(with(node, {1, 2, 3})).message, "2 values for 3 keys"));
  CHECK(contains(failure_of(with(node, {})).message, "/samplers/0/input: has no keys"));
  CHECK(contains(failure_of(with({{"node", 9}, {"path", "scale"}}, {0, 1})).message,
                 "/animations/0/channels/0/target/node: there is no node 9"));
}

}  // namespace psf::render
