// What the command line changes, the camera of a scene without one, and the hash.
#include <numbers>
#include <set>

#include "catch.h"
#include "load_support.h"
#include "render/scene/load_parts.h"

namespace psf::render {
namespace {

const std::string kTwoCameras = R"({
  "cameras": [{"name": "a", "eye": [0, 0, 5], "target": [0, 0, 0]}, {"name": "b",
      "eye": [5, 0, 0], "target": [0, 0, 0]}],
  "materials": [{"name": "m", "emission": 1}],
  "shapes": [{"shape": "box", "material": "m", "min": [-1, -1, -1], "max": [1, 1, 1]}]})";

Scene load_with(const SceneOverrides& overrides, const std::string& text = kTwoCameras) {
  const TempFolder folder;
  return load_scene(folder.write("s.json", text), overrides);
}
Failure failure(const SceneOverrides& overrides) {
  const TempFolder folder;
  return load_failure(folder.write("s.json", kTwoCameras), overrides);
}

TEST_CASE("size and field of view change every camera, a pose leaves one", "[load][overrides]") {
  SceneOverrides o;
  o.size = Vec2(40, 30);
  o.fov = 90.0f;
  Scene scene = load_with(o);
  REQUIRE(scene.cameras.size() == 2);
  for (const Camera& camera : scene.cameras) {
    CHECK((camera.width == 40 && camera.height == 30));
    CHECK(camera.fov == Approx(std::numbers::pi / 2));
  }
  o.eye = Imath::V3d(0, 3, 9);
  o.up = Vec3(0, 0, -2);
  scene = load_with(o);
  REQUIRE(scene.cameras.size() == 1);
  CHECK(scene.cameras[0].name == "a");
  CHECK(scene.cameras[0].eye == Vec3(0, 3, 9));
  CHECK(scene.cameras[0].target == Vec3(0, 0, 0));
  CHECK(scene.cameras[0].up == Vec3(0, 0, -1));
}

TEST_CASE("sky and sun replace and add light", "[load][overrides]") {
  const TempFolder folder;
  SceneOverrides o;
  o.sky = Rgb(1, 2, 3);
  o.sun_direction = Vec3(0, 2, 0);
  o.sun = Rgb(4);
  Scene scene = load_with(o);
  CHECK(scene.environment.radiance == Rgb(1, 2, 3));
  CHECK(scene.environment.texture == kNone);
  REQUIRE(scene.lights.size() == 1);
  CHECK(scene.lights[0].kind == LightKind::directional);
  CHECK(scene.lights[0].direction == Vec3(0, -1, 0));
  CHECK(scene.lights[0].intensity == Rgb(4));
  CHECK(scene.lights[0].angle == o.sun_angle);
  o.sky.reset();
  o.sky_map = folder.write("sky.ppm", ppm(2, "255 255 255 0 0 0"));
  scene = load_with(o);
  REQUIRE(scene.environment.texture != kNone);
  CHECK(scene.environment.radiance == Rgb(1));
  CHECK(scene.textures.at(static_cast<std::size_t>(scene.environment.texture)).width() == 2);
}

TEST_CASE("senseless values of the command line are errors of usage", "[load][overrides]") {
  SceneOverrides o;
  o.fov = 180.0f;
  CHECK(failure(o).code == ErrorCode::usage);
  CHECK(failure(o).message == "`fov 180`: expected degrees between 0 and 180");
  o = {};
  o.size = Vec2(0, 10);
  CHECK(failure(o).code == ErrorCode::usage);
  CHECK(failure(o).message == "`size 0x10`: expected whole numbers of pixels from 1 to 65535");
  o = {};
  o.size = Vec2(65536, 10);
  CHECK(failure(o).code == ErrorCode::usage);
  o.size = Vec2(65535, 65535);
  CHECK(failure(o).code == ErrorCode::limit);
  o = {};
  o.up = Vec3(0, 0, 0);
  CHECK(failure(o).code == ErrorCode::usage);
  o = {};
  o.sky = Rgb(-1, 0, 0);
  CHECK(failure(o).code == ErrorCode::usage);
  o = {};
  o.sky_map = "/nowhere/sky.exr";
  CHECK(failure(o).code == ErrorCode::io);
}

TEST_CASE("cameras that see nothing are refused", "[load][overrides]") {
  SceneOverrides o;
  o.eye = o.target = Imath::V3d(1, 2, 3);
  CHECK(failure(o).message ==
        "s.json: camera 0 a: eye and target are the same point, so it looks nowhere");
  CHECK(failure(o).code == ErrorCode::bad_input);
  o.eye = Imath::V3d(1, 9, 3);
  CHECK(failure(o).message ==
        "s.json: camera 0 a: looks along its up direction; choose another \"up\"");
}

TEST_CASE("a lens wider than rays can begin is refused", "[load][overrides]") {
  const TempFolder folder;
  const std::string wide = R"({"cameras": [{"eye": [0, 0, 5], "target": [0, 0, 0],
      "lens_radius": 1e30}], "materials": [{"name": "m"}],
      "shapes": [{"shape": "sphere", "material": "m", "center": [0, 0, 0], "radius": 1}]})";
  const Failure refused = load_failure(folder.write("s.json", wide));
  CHECK(refused.code == ErrorCode::limit);
  CHECK(refused.message == "s.json: camera 0: the lens is wider than 1e+18 times the scene's size");
}

TEST_CASE("a scene without camera gets one from which every vertex is in the picture",
          "[load][overrides]") {
  const Scene scene = load_with({}, R"({"materials": [{"name": "m"}], "shapes": [
    {"shape": "box", "material": "m", "min": [10, -3, 5], "max": [14, 30, 6]},
    {"shape": "sphere", "material": "m", "center": [-4, 0, 0], "radius": 3}]})");
  const Camera& camera = scene.cameras.at(0);
  const float limit = std::tan(camera.fov / 2);
  for (const Vec3& p : scene.meshes[0].positions) {
    const Vec3 seen = p - camera.eye;
    CHECK(seen.z < 0);
    CHECK(std::abs(seen.x / seen.z) < limit);
    CHECK(std::abs(seen.y / seen.z) < limit);
  }
  REQUIRE(scene.warnings.size() == 1);
  CHECK(contains(scene.warnings[0], "nothing in the scene gives light"));
}

TEST_CASE("files that are no scenes", "[load]") {
  const TempFolder folder;
  CHECK(load_failure("/nowhere/x.json").code == ErrorCode::io);
  CHECK(load_failure("/nowhere/x.json").message == "x.json: no such file");
  CHECK(load_failure(folder.write("s.blend", "x")).code == ErrorCode::bad_input);
  const std::string inside = folder.write("d.json/x", "x");
  CHECK(load_failure(inside.substr(0, inside.size() - 2)).message ==
        "d.json: is a folder, a scene file is needed");
}

TEST_CASE("whatever shapes the picture changes the hash, names do not", "[load][hash]") {
  Scene base;
  base.textures.emplace_back(2, 1, std::vector<Rgb>{Rgb(0), Rgb(1)});
  base.materials.resize(1);
  Mesh mesh;
  mesh.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  mesh.triangles = {{0, 1, 2}};
  base.meshes = {mesh};
  base.spheres.resize(1);
  base.lights.resize(1);
  base.cameras.resize(1);
  const std::vector<void (*)(Scene&)> changes = {
      [](Scene& s) {
        s.textures[0] = Texture(2, 1, {Rgb(0), Rgb(0.5f)});
      },
      [](Scene& s) {
        s.textures[0] = Texture(1, 2, {Rgb(0), Rgb(1)});
      },
      [](Scene& s) { s.materials[0].kind = MaterialKind::glass; },
      [](Scene& s) { s.materials[0].reflectance.y += 1e-6f; },
      [](Scene& s) { s.materials[0].reflectance_texture = 0; },
      [](Scene& s) { s.materials[0].roughness = 0.51f; },
      [](Scene& s) { s.materials[0].metalness = 0.5f; },
      [](Scene& s) { s.materials[0].roughness_metalness_texture = 0; },
      [](Scene& s) { s.materials[0].ior = 1.6f; },
      [](Scene& s) { s.materials[0].two_sided = false; },
      [](Scene& s) { s.materials[0].emits_two_sided = true; },
      [](Scene& s) { s.materials[0].emission.z = 1; },
      [](Scene& s) { s.materials[0].emission_texture = 0; },
      [](Scene& s) { s.meshes[0].positions[2].z = 1e-6f; },
      [](Scene& s) {
        s.meshes[0].triangles[0] = {0, 2, 1};
      },
      [](Scene& s) { s.meshes[0].normals.assign(3, Vec3(0, 0, 1)); },
      [](Scene& s) { s.meshes[0].uvs.assign(3, Vec2(0, 0)); },
      [](Scene& s) { s.meshes[0].material = 1; },
      [](Scene& s) { s.meshes.push_back(s.meshes[0]); },
      [](Scene& s) { s.spheres[0].radius = 2; },
      [](Scene& s) { s.spheres[0].center.x = 2; },
      [](Scene& s) { s.spheres[0].material = 1; },
      [](Scene& s) { s.lights[0].kind = LightKind::spot; },
      [](Scene& s) { s.lights[0].position.x = 5; },
      [](Scene& s) { s.lights[0].direction.x = 0.5f; },
      [](Scene& s) { s.lights[0].intensity.x = 5; },
      [](Scene& s) { s.lights[0].cos_inner = 0.5f; },
      [](Scene& s) { s.lights[0].cos_outer = 0.5f; },
      [](Scene& s) { s.lights[0].angle = 0.5f; },
      [](Scene& s) { s.environment.radiance.x = 1; },
      [](Scene& s) { s.environment.texture = 0; },
      [](Scene& s) { s.environment.rotation = 1; },
      [](Scene& s) { s.cameras[0].eye.x = 1; },
      [](Scene& s) { s.cameras[0].target.x = 1; },
      [](Scene& s) { s.cameras[0].up.x = 1; },
      [](Scene& s) { s.cameras[0].fov = 1; },
      [](Scene& s) { s.cameras[0].width = 100; },
      [](Scene& s) { s.cameras[0].height = 100; },
      [](Scene& s) { s.cameras[0].lens_radius = 1; },
      [](Scene& s) { s.cameras[0].focus_distance = 2; },
  };
  std::set<std::string> hashes{hash_of(base)};
  CHECK(hashes.begin()->size() == 32);
  for (const auto change : changes) {
    Scene scene = base;
    change(scene);
    hashes.insert(hash_of(scene));
  }
  CHECK(hashes.size() == changes.size() + 1);
  base.media.resize(2);
  base.materials[0].kind = MaterialKind::subsurface;
  base.materials[0].interior = 0;
  std::set<std::string> with_media{hash_of(base)};
  const std::vector<void (*)(Scene&)> media_changes = {
      [](Scene& s) { s.media[0].sigma_a.x = 1; }, [](Scene& s) { s.media[0].sigma_s.z = 1; },
      [](Scene& s) { s.media[0].g = 0.5f; }, [](Scene& s) { s.materials[0].interior = 1; },
      [](Scene& s) { s.medium = 0; }};
  for (const auto change : media_changes) {
    Scene scene = base;
    change(scene);
    with_media.insert(hash_of(scene));
  }
  CHECK(with_media.size() == media_changes.size() + 1);
  Scene renamed = base;
  renamed.name = renamed.materials[0].name = renamed.meshes[0].name = renamed.cameras[0].name =
      "other";
  CHECK(hash_of(renamed) == hash_of(base));
}

}  // namespace
}  // namespace psf::render
