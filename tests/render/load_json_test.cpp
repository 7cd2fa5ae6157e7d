// The JSON scene file: what each key does.
#include <numbers>

#include "catch.h"
#include "density_support.h"
#include "load_support.h"

namespace psf::render {
namespace {

Scene load_text(const std::string& text) {
  const TempFolder folder;
  return load_scene(folder.write("s.json", text));
}
Scene load_shape(const std::string& shape) {
  return load_text(with_shapes(shape));
}

Vec3 normal_of(const Mesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a])
      .normalized();
}

// Volume by the divergence theorem: positive only where the triangles close a body and face
// outward.
double volume_of(const Mesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum +=
        static_cast<double>(dot(mesh.positions[a], cross(mesh.positions[b], mesh.positions[c]))) /
        6;
  }
  return sum;
}

TEST_CASE("every key of a camera, a light and the environment arrives", "[load][json]") {
  const Scene scene = load_text(R"({
    "comment": "no shape of a scene may be missing",
    "cameras": [{"name": "a", "eye": [1, 2, 3], "target": [4, 2, 3], "up": [0, 0, 2], "fov": 90,
        "size": [64, 48],
                 "lens_radius": 0.1, "focus_distance": 7}, {"eye": [0, 0, 5], "target": [0, 0, 0]}],
    "environment": {"radiance": [1, 2, 3], "rotation": 180},
    "lights": [{"kind": "point", "name": "p", "position": [1, 1, 1], "intensity": 5},
               {"kind": "directional", "direction": [0, -2, 0], "irradiance": [1, 2, 3],
                   "angle": 90},
               {"kind": "spot", "position": [0, 3, 0], "target": [0, 0, 0], "intensity": 2,
                   "inner": 0, "outer": 60}],
    "materials": [{"name": "m"}],
    "shapes": [{"shape": "sphere", "material": "m", "center": [0, 1, 0], "radius": 2}]})");
  REQUIRE(scene.cameras.size() == 2);
  const Camera& camera = scene.cameras[0];
  CHECK(camera.name == "a");
  check_point(camera.eye, {1, 2, 3});
  check_point(camera.up, {0, 0, 1});
  CHECK(camera.fov == Approx(std::numbers::pi / 2));
  CHECK((camera.width == 64 && camera.height == 48));
  CHECK(camera.lens_radius == 0.1f);
  CHECK(camera.focus_distance == 7);
  CHECK(scene.cameras[1].focus_distance == 5);
  CHECK(scene.environment.radiance == Rgb(1, 2, 3));
  CHECK(scene.environment.rotation == Approx(std::numbers::pi));
  REQUIRE(scene.lights.size() == 3);
  CHECK(scene.lights[0].kind == LightKind::point);
  CHECK(scene.lights[0].intensity == Rgb(5));
  check_point(scene.lights[1].direction, {0, -1, 0});
  CHECK(scene.lights[1].angle == Approx(std::numbers::pi / 2));
  check_point(scene.lights[2].direction, {0, -1, 0});
  CHECK(scene.lights[2].cos_inner == 1);
  CHECK(scene.lights[2].cos_outer == Approx(0.5));
  CHECK(scene.spheres[0].radius == 2);
  CHECK(scene.name == "s.json");
}

TEST_CASE("every key of a material arrives", "[load][json]") {
  const TempFolder folder;
  folder.write("tex/wood.ppm", ppm(1, "255 0 0"));
  const Scene scene = load_scene(folder.write("s.json", R"({
    "materials": [
      {"name": "m", "kind": "coat", "reflectance": [0.1, 0.2, 0.3], "roughness": 0.4,
          "metalness": 0.6, "ior": 1.7,
       "two_sided": false, "emits_two_sided": true, "emission": 2,
           "reflectance_map": "tex/wood.ppm",
       "roughness_metalness_map": "tex/wood.ppm", "emission_map": "tex/wood.ppm"},
      {"name": "plain"}, {"name": "glass", "kind": "glass"}, {"name": "picture",
          "reflectance_map": "tex/wood.ppm"}],
    "shapes": [{"shape": "sphere", "material": "m", "center": [0, 0, 0], "radius": 1}]})"));
  const Material& m = scene.materials[0];
  CHECK(m.kind == MaterialKind::coat);
  CHECK(m.reflectance == Rgb(0.1f, 0.2f, 0.3f));
  CHECK(m.roughness == 0.4f);
  CHECK(m.metalness == 0.6f);
  CHECK(m.ior == 1.7f);
  CHECK(!m.two_sided);
  CHECK(m.emits_two_sided);
  CHECK(m.emission == Rgb(2));
  // Loaded once for each use: reflectances have a range, radiances have none, numbers are no
  // colours.
  CHECK(scene.textures.size() == 3);
  CHECK(scene.materials[3].reflectance_texture == m.reflectance_texture);
  CHECK(m.reflectance_texture != m.emission_texture);
  CHECK(m.roughness_metalness_texture != m.reflectance_texture);
  CHECK(scene.materials[1].reflectance == Rgb(0.5f));
  CHECK(scene.materials[2].reflectance == Rgb(1));
  CHECK(scene.materials[3].reflectance == Rgb(1));
}

TEST_CASE("every key of a medium arrives, in the unit of the scene's space", "[load][json]") {
  const TempFolder folder;
  const auto load = [&](const std::string& radius) {
    return load_scene(folder.write("s.json", R"({
      "media": [
        {"name": "milk", "albedo": [1, 0.75, 0.5], "mean_free_path": [0.5, 1, 2], "g": 0.9},
        {"name": "ink", "sigma_a": [1, 2, 3], "sigma_s": 4}],
      "materials": [
        {"name": "drop", "kind": "subsurface", "interior": "ink", "ior": 1.3, "roughness": 0.2},
        {"name": "cloud", "kind": "volume", "interior": "milk"}],
      "medium": "ink",
      "shapes": [{"shape": "sphere", "material": "drop", "center": [0, 0, 0], "radius": )" +
                                                 radius + "}]}"));
  };
  const Scene scene = load("1");
  REQUIRE(scene.media.size() == 2);
  CHECK(scene.media[0].sigma_s == Rgb(2, 0.75f, 0.25f));
  CHECK(scene.media[0].sigma_a == Rgb(0, 0.25f, 0.25f));
  CHECK(scene.media[0].g == 0.9f);
  CHECK(scene.media[1].sigma_a == Rgb(1, 2, 3));
  CHECK(scene.media[1].sigma_s == Rgb(4));
  CHECK(scene.media[1].g == 0);
  CHECK(scene.materials[0].kind == MaterialKind::subsurface);
  CHECK(scene.materials[0].interior == 1);
  CHECK(scene.materials[1].kind == MaterialKind::volume);
  CHECK(scene.materials[1].interior == 0);
  CHECK(scene.medium == 1);
  const Scene huge = load("1e9");
  CHECK(huge.space.exponent > 0);
  CHECK(huge.media[1].sigma_s.x == std::ldexp(4.0f, huge.space.exponent));
}

TEST_CASE("the density of a medium stands where its transform puts it, at any scale",
          "[load][json]") {
  const TempFolder folder;
  // Mist that thins out along y, from 4 to 6; the second scene is a billion times larger.
  for (const std::string scale : {"1", "1e9"}) {
    const Scene scene = load_scene(folder.write("s.json", R"({
      "media": [{"name": "mist", "albedo": 1, "mean_free_path": )" +
                                                              scale + R"(,
        "density": {"kind": "mist", "min": [-1, 0, -1], "max": [1, 1, 1], "voxels": 16,
          "transform": [{"scale": [1, 2, 3]}, {"translate": [0, 4, 0]}, {"scale": )" +
                                                              scale +
                                                              R"(}]}}],
      "medium": "mist", "materials": [{"name": "grey"}],
      "shapes": [{"shape": "sphere", "material": "grey", "center": [0, 0, 0], "radius": )" +
                                                              scale + "}]}"));
    const double unit = scale == "1" ? 1 : 1e9;
    CHECK((scene.space.exponent > 0) == (unit > 1));
    CHECK(std::abs(scene.media[0].sigma_s.x * scene.space.local_length(unit) - 1) < 1e-5f);
    const auto at = [&](double x, double y, double z) {
      return test::density_at(*scene.media[0].density,
                              Imath::V3d(scene.space.local(Imath::V3d(x, y, z) * unit)));
    };
    CHECK(std::abs(at(0.3, 4.5, 2.9) - 0.75) < 1e-5);
    CHECK(std::abs(at(-0.9, 5.8, -2.9) - 0.1) < 1e-5);
    CHECK(at(0.3, 3.9, 0) == 0);
    CHECK(at(0.3, 4.5, 3.1) == 0);
    CHECK(at(1.1, 4.5, 0) == 0);
  }
}

TEST_CASE("transforms apply in order", "[load][json]") {
  const std::string quad =
      R"({"shape": "quad", "material": "white", "origin": [1, 0, 0], "u": [1, 0, 0],
          "v": [0, 1, 0])";
  // A quarter turn about y takes x to -z; then 10 up.
  Scene scene = load_shape(
      quad + R"(, "transform": [{"rotate": 90, "axis": "y"}, {"translate": [0, 10, 0]}]})");
  check_point(scene.meshes[0].positions[0], {0, 10, -1});
  check_point(scene.meshes[0].positions[1], {0, 10, -2});
  check_point(normal_of(scene.meshes[0], 0), {1, 0, 0});
  // The other order, about an axis given as numbers: x to y, y to -x.
  scene = load_shape(
      quad + R"(, "transform": [{"translate": [0, 10, 0]}, {"rotate": 90, "axis": [0, 0, 3]}]})");
  check_point(scene.meshes[0].positions[0], {-10, 1, 0});
  scene = load_shape(
      quad + R"(, "transform": {"matrix": [0, 2, 0, 5,  1, 0, 0, 6,  0, 0, 1, 7,  0, 0, 0, 1]}})");
  check_point(scene.meshes[0].positions[0], {5, 7, 7});
  check_point(scene.meshes[0].positions[2], {7, 8, 7});
  // A mirror keeps the front in front.
  scene = load_shape(quad + R"(, "transform": {"scale": [-1, 1, 1]}})");
  check_point(scene.meshes[0].positions[1], {-2, 0, 0});
  check_point(normal_of(scene.meshes[0], 0), {0, 0, 1});
  scene = load_shape(quad + R"(, "flip": true})");
  check_point(normal_of(scene.meshes[0], 0), {0, 0, -1});
}

TEST_CASE("repetition of groups multiplies, outer steps after inner transforms", "[load][json]") {
  const Scene scene = load_shape(R"({"shape": "group", "transform": {"scale": 2},
    "repeat": [{"count": 2, "step": {"translate": [10, 0, 0]}}, {"count": 3,
        "step": {"translate": [0, 100, 0]}}],
    "shapes": [{"shape": "sphere", "material": "white", "center": [1, 0, 0], "radius": 1,
                "repeat": {"count": 2, "step": [{"rotate": 180, "axis": "y"}]}},
               {"shape": "box", "material": "white", "min": [0, 0, 0], "max": [1, 1, 1]}]})");
  REQUIRE(scene.spheres.size() == 12);
  check_point(scene.spheres[0].center, {2, 0, 0});
  check_point(scene.spheres[1].center, {-2, 0, 0});
  check_point(scene.spheres[2].center, {12, 0, 0});
  check_point(scene.spheres[11].center, {8, 200, 0});
  CHECK(scene.spheres[11].radius == Approx(2));
  REQUIRE(scene.meshes.size() == 1);
  CHECK(scene.meshes[0].triangles.size() == 6 * 12);
  CHECK(volume_of(scene.meshes[0]) == Approx(6 * 8));
}

TEST_CASE("bodies are closed, face outward and have the volume of their formula", "[load][json]") {
  const auto volume = [](const std::string& shape) {
    return volume_of(load_shape(shape).meshes.at(0));
  };
  CHECK(volume(R"({"shape": "box", "material": "white", "min": [-1, 0, 2], "max": [1, 3, 6]})") ==
        Approx(24));
  CHECK(volume(
            R"({"shape": "box", "material": "white", "min": [-1, 0, 2], "max": [1, 3, 6],
              "flip": true})") == Approx(-24));
  // A prism over a regular 8-gon.
  const double polygon = 8 * std::sin(2 * std::numbers::pi / 8) / 2;
  CHECK(volume(
            R"({"shape": "cylinder", "material": "white", "from": [5, 1, 2], "to": [5, 1, 5],
              "radius": 2,
                   "segments": 8})") == Approx(polygon * 4 * 3));
  CHECK(volume(
            R"({"shape": "cylinder", "material": "white", "from": [0, 0, 0], "to": [1, 1, 0],
              "radius": 1,
                   "to_radius": 0, "segments": 8})") == Approx(polygon * std::sqrt(2.0) / 3));
  CHECK(volume(R"({"shape": "lathe", "material": "white", "segments": 8,
                   "profile": [[0, 1], [2, 1], [2, 4], [0, 4]]})") == Approx(polygon * 4 * 3));
  // Panel minus half an ellipse, to what the segments leave of it.
  CHECK(volume(
            R"({"shape": "arch", "material": "white", "width": 4, "height": 3, "depth": 0.5,
              "span": 2, "rise": 2,
                   "segments": 400})") == Approx((12 - std::numbers::pi) * 0.5).epsilon(1e-4));
}

TEST_CASE("normals of lathed bodies point outward and are unit", "[load][json]") {
  const Scene scene =
      load_shape(R"({"shape": "lathe", "material": "white", "profile": [[1, 0], [2, 1], [1, 5]],
                                     "transform": {"scale": [1, 2, 1]}})");
  const Mesh& mesh = scene.meshes[0];
  REQUIRE(mesh.normals.size() == mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 flat = normal_of(mesh, t);
    for (const std::uint32_t i : mesh.triangles[t]) {
      CHECK(mesh.normals[i].length() == Approx(1));
      CHECK(dot(mesh.normals[i], flat) > 0.99f);
    }
  }
}

TEST_CASE("inline meshes and mesh files arrive, with a material of the scene or their own",
          "[load][json]") {
  const TempFolder folder;
  folder.write("m/tri.obj", "mtllib tri.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl green\nf 1 2 3\n");
  folder.write("m/tri.mtl", "newmtl green\nKd 0.1 0.9 0.2\n");
  const Scene scene = load_scene(folder.write("s.json", with_shapes(R"(
    {"shape": "mesh", "material": "lamp", "positions": [[0,0,0],[1,0,0],[0,1,0]],
        "triangles": [[0,1,2]],
     "normals": [[0,0,2],[0,0,1],[0,0,1]], "uvs": [[0,0],[1,0],[0,1]], "uv_scale": [2, 3]},
    {"shape": "mesh", "file": "m/tri.obj", "transform": {"translate": [0, 0, 5]}},
    {"shape": "mesh", "file": "m/tri.obj", "material": "white", "repeat": {"count": 2,
        "step": {"translate": [1,0,0]}}})")));
  REQUIRE(scene.meshes.size() == 3);
  CHECK(scene.meshes[0].uvs[2] == Vec2(0, 3));
  check_point(scene.meshes[0].normals[0], {0, 0, 1});
  check_point(scene.meshes[1].positions[1], {1, 0, 5});
  CHECK(scene.materials[static_cast<std::size_t>(scene.meshes[1].material)].reflectance ==
        Rgb(0.1f, 0.9f, 0.2f));
  CHECK(scene.meshes[2].material == 0);
  CHECK(scene.meshes[2].triangles.size() == 2);
}

TEST_CASE("materials of a mesh file keep all their pictures among those of the scene",
          "[load][json]") {
  const TempFolder folder;
  folder.write("one.ppm", ppm(1, "255 0 0"));
  folder.write("two.ppm", ppm(1, "0 255 0"));
  folder.write("m/tri.obj",
               "mtllib tri.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
  folder.write("m/tri.mtl",
               "newmtl m\nmap_Kd ../one.ppm\nmap_d ../two.ppm\nmap_Bump ../two.ppm\n"
               "norm ../one.ppm\nmap_Ke ../two.ppm\n");
  const std::string included = R"("shapes": [{"shape": "mesh", "file": "m/tri.obj"}])";
  const Scene alone = load_scene(folder.write("a.json", "{" + included + "}"));
  Scene scene = load_scene(folder.write("s.json", R"({"materials": [
      {"name": "before", "reflectance_map": "one.ppm"}], )" +
                                                      included + "}"));
  REQUIRE(alone.materials.size() == 1);
  REQUIRE(scene.materials.size() == 2);
  Material own = alone.materials[0];
  std::size_t pictures = 0;
  for (std::size_t k = 0; k < own.textures().size(); ++k) {
    const int before = *own.textures()[k], now = *scene.materials[1].textures()[k];
    pictures += before != kNone;
    CHECK(now == (before == kNone ? kNone : before + 1));
  }
  CHECK(pictures >= 4);
}

}  // namespace
}  // namespace psf::render
