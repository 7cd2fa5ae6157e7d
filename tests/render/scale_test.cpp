// Pictures do not depend on the size of a scene, nor on where it lies.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "catch.h"
#include "formats/layout/metadata.h"
#include "load_support.h"
#include "render/loop/render.h"
#include "render_dump.h"

namespace psf::render {
namespace {

using Imath::V3d;
using nlohmann::json;

// Lengths times `scale`, then moved by `offset`.
struct Move {
  double scale = 1;
  V3d offset{0, 0, 0};

  [[nodiscard]] V3d operator()(const V3d& p) const { return p * scale + offset; }
};

json array(const V3d& v) {
  return json::array({v.x, v.y, v.z});
}
std::string triple(const V3d& v) {
  return array(v).dump();
}

json quad(const char* material, const V3d& origin, const V3d& u, const V3d& v) {
  return {{"shape", "quad"},
          {"material", material},
          {"origin", array(origin)},
          {"u", array(u)},
          {"v", array(v)}};
}

// A Cornell box of 2 units with a mirror and a glass ball under a square lamp, and a spot light.
json box_shapes() {
  return json::array(
      {quad("white", {-1, 0, 1}, {2, 0, 0}, {0, 0, -2}),
       quad("white", {-1, 2, -1}, {2, 0, 0}, {0, 0, 2}),
       quad("white", {-1, 0, -1}, {2, 0, 0}, {0, 2, 0}),
       quad("red", {-1, 0, 1}, {0, 0, -2}, {0, 2, 0}),
       quad("green", {1, 0, -1}, {0, 0, 2}, {0, 2, 0}),
       quad("lamp", {-0.3, 1.99, -0.3}, {0.6, 0, 0}, {0, 0, 0.6}),
       {{"shape", "box"}, {"material", "white"}, {"min", {-0.8, 0, -0.6}}, {"max", {-0.2, 1, 0}}},
       {{"shape", "sphere"}, {"material", "mirror"}, {"center", {0.4, 0.4, -0.4}}, {"radius", 0.4}},
       {{"shape", "sphere"}, {"material", "glass"}, {"center", {0.4, 0.3, 0.4}}, {"radius", 0.3}}});
}

json box_scene(const Move& move) {
  json scene;
  scene["cameras"] = {{{"name", "front"},
                       {"eye", array(move({0, 1, 4.2}))},
                       {"target", array(move({0, 1, 0}))},
                       {"fov", 34.5},
                       {"size", {32, 32}},
                       {"lens_radius", 0.02 * move.scale},
                       {"focus_distance", 4 * move.scale}}};
  scene["materials"] = {{{"name", "white"}, {"reflectance", 0.7}},
                        {{"name", "red"}, {"reflectance", {0.6, 0.06, 0.05}}},
                        {{"name", "green"}, {"reflectance", {0.12, 0.46, 0.1}}},
                        {{"name", "mirror"}, {"kind", "mirror"}},
                        {{"name", "glass"}, {"kind", "glass"}},
                        {{"name", "lamp"}, {"reflectance", 0}, {"emission", 17}}};
  // Beyond, its intensity is no float.
  if (move.scale <= 1e18) {
    scene["lights"] = {{{"kind", "spot"},
                        {"position", array(move({0.8, 1.8, 0.8}))},
                        {"target", array(move({-0.5, 0, -0.5}))},
                        {"outer", 30},
                        {"intensity", 2 * move.scale * move.scale}}};
  }
  scene["shapes"] = {
      {{"shape", "group"},
       {"shapes", box_shapes()},
       {"transform", {{{"scale", move.scale}}, {{"translate", array(move.offset)}}}}}};
  return scene;
}

// The same by coordinates alone, without transforms.
json coordinates(const Move& move) {
  json scene = box_scene(move);
  json shapes = box_shapes();
  const auto vector = [](const json& v) { return V3d(v[0], v[1], v[2]); };
  for (json& shape : shapes) {
    for (const char* point : {"origin", "min", "max", "center"}) {
      if (shape.contains(point)) shape[point] = array(move(vector(shape[point])));
    }
    for (const char* edge : {"u", "v"}) {
      if (shape.contains(edge)) shape[edge] = array(vector(shape[edge]) * move.scale);
    }
    if (shape.contains("radius")) shape["radius"] = shape["radius"].get<double>() * move.scale;
  }
  scene["shapes"] = shapes;
  return scene;
}

RenderSettings settings_of(const std::string& integrator, std::uint64_t seed) {
  RenderSettings settings = tests::quiet_settings(8);
  settings.integrator.name = integrator;
  settings.sampler.seed = seed;
  return settings;
}

std::vector<Rgb> picture(const Scene& scene, std::uint64_t seed = 0,
                         const std::string& integrator = "path", double ao_distance = 1,
                         double scale = 1) {
  RenderSettings settings = settings_of(integrator, seed);
  if (integrator == "ao") settings.integrator.ao_distance = static_cast<float>(ao_distance);
  settings.integrator.vpl_distance = static_cast<float>(0.2 * scale);
  settings.integrator.photon_paths = 4096;
  settings.integrator.photon_radius = static_cast<float>(0.1 * scale);
  const auto made = make_integrator(scene, settings.integrator);
  const auto mean = render::render(scene, *made, settings, nullptr).films[0].mean();
  std::vector<Rgb> pixels;
  for (std::size_t k = 0; k + 2 < mean.size(); k += 3) {
    pixels.emplace_back(mean[k], mean[k + 1], mean[k + 2]);
  }
  return pixels;
}

double rel_mse(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double d = double{a[i][c]} - double{b[i][c]}, g = double{b[i][c]};
      sum += d * d / (g * g + 0.01);
    }
  }
  return sum / static_cast<double>(3 * a.size());
}

double mean_of(const std::vector<Rgb>& pixels) {
  double sum = 0;
  for (const Rgb& p : pixels) sum += double{p.x} + double{p.y} + double{p.z};
  return sum / static_cast<double>(3 * pixels.size());
}

Scene load_json(const TempFolder& folder, const json& scene) {
  return load_scene(folder.write("s.json", scene.dump()));
}

const Move kMoves[] = {{1e-6, {0, 0, 0}},      {1e-4, {0, 0, 0}},
                       {0.01, {0, 0, 0}},      {300, {0, 0, 0}},
                       {1e4, {0, 0, 0}},       {1e6, {0, 0, 0}},
                       {1, {1e7, -1e7, 1e7}},  {1, {408202.08, 4080928.5, 100}},
                       {1e-3, {1e7, 0, 0}},    {1e-4, {0, 0, -1e7}},
                       {100, {1e7, 1e7, 1e7}}, {1e6, {1e7, 0, -1e7}},
                       {1e-6, {0.3, 700, 0}},  {1e-13, {0, 0, 0}},
                       {1e11, {0, 0, 0}},      {1e18, {0, 1e19, 0}}};

TEST_CASE("a Cornell box of any size and anywhere is the same picture", "[scale]") {
  const TempFolder folder;
  const std::vector<Rgb> expected = picture(load_json(folder, box_scene({})));
  const double noise = rel_mse(picture(load_json(folder, box_scene({})), 1), expected);
  CHECK(noise > 0.01);
  for (const Move& move : kMoves) {
    for (const bool transformed : {true, false}) {
      const Scene scene = load_json(folder, transformed ? box_scene(move) : coordinates(move));
      const std::vector<Rgb> found = picture(scene);
      INFO(move.scale << " at " << triple(move.offset));
      // The same numbers of the sampler: what is left are paths that rounding sends elsewhere.
      CHECK(rel_mse(found, expected) < 0.25 * noise);
      CHECK(std::abs(mean_of(found) / mean_of(expected) - 1) < 0.005);
    }
  }
}

TEST_CASE("ambient occlusion reaches as far in a scene of any size and anywhere", "[scale]") {
  const TempFolder folder;
  const std::vector<Rgb> expected = picture(load_json(folder, box_scene({})), 0, "ao", 0.5);
  for (const Move& move : kMoves) {
    INFO(move.scale << " at " << triple(move.offset));
    const auto found = picture(load_json(folder, box_scene(move)), 0, "ao", 0.5 * move.scale);
    CHECK(std::abs(mean_of(found) / mean_of(expected) - 1) < 0.005);
  }
}

TEST_CASE("light paths give the same picture in a scene of any size and anywhere", "[scale]") {
  const TempFolder folder;
  const auto name = GENERATE(as<std::string>(), "vpl", "photon");
  const std::vector<Rgb> expected = picture(load_json(folder, box_scene({})), 0, name);
  for (const Move& move : kMoves) {
    INFO(name << ": " << move.scale << " at " << triple(move.offset));
    const auto found = picture(load_json(folder, box_scene(move)), 0, name, 1, move.scale);
    CHECK(std::abs(mean_of(found) / mean_of(expected) - 1) < 0.01);
  }
}

// Positions in the file against those of the scene at its own place.
TEST_CASE("a dump of a scene of any size and anywhere has world units", "[scale]") {
  const TempFolder folder;
  const auto dump = [&](const Move& move) {
    const Scene scene = load_json(folder, box_scene(move));
    const RenderSettings settings = settings_of("direct", 0);
    const auto integrator = make_integrator(scene, settings.integrator);
    const tests::TempFolder out;
    formats::WriterOptions options;
    options.sync = false;
    {
      formats::Writer writer(out / "a.pvb", make_head(scene, *integrator, settings), options);
      (void)render::render(scene, *integrator, settings, &writer);
    }
    const formats::Reader reader(out / "a.pvb");
    const auto camera = formats::parse_metadata(reader.head().metadata).cameras.at(0);
    const V3d eye = move({0, 1, 4.2});
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(camera.camera_to_world[4 * k + 3] ==
            Approx(eye[static_cast<int>(k)]).margin(1e-6 * move.scale));
    }
    return tests::read_all(out / "a.pvb");
  };
  const tests::Columns expected = dump({});
  const auto positions = tests::values<Vec3>(expected, "position");
  const auto distances = tests::values<float>(expected, "distance");
  const auto hits = tests::values<float>(expected, "hit_distance");
  REQUIRE(std::count(positions.begin(), positions.end(), Vec3(0, 0, 0)) > 0);
  for (const Move& move : kMoves) {
    const tests::Columns found = dump(move);
    const auto moved = tests::values<Vec3>(found, "position");
    const auto far = tests::values<float>(found, "distance");
    const auto hit = tests::values<float>(found, "hit_distance");
    std::size_t wrong = 0, misplaced = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const V3d right = move(V3d(positions[i]));
      const double reach = std::max({std::abs(right.x), std::abs(right.y), std::abs(right.z)});
      const bool has_vertex = positions[i] != Vec3(0, 0, 0);
      if (!has_vertex && moved[i] != Vec3(0, 0, 0)) ++misplaced;
      const double off = (V3d(moved[i]) - right).length();
      // Rays start off a surface by some 2^-19 of its coordinates, so what mirrors show shifts.
      const double slack = 2e-5 * move.scale + std::min(reach * 0x1p-17, 2e-4 * move.scale);
      const bool near = off < slack + reach * 0x1p-23;
      const bool long_right = std::abs(double{far[i]} - double{distances[i]} * move.scale) < slack;
      const bool hit_right =
          std::isinf(hit[i]) == std::isinf(hits[i]) &&
          (std::isinf(hit[i]) ||
           std::abs(double{hit[i]} - double{hits[i]} * move.scale) < 1e-3 * move.scale);
      wrong += has_vertex && !(near && long_right && hit_right) ? 1u : 0u;
    }
    INFO(move.scale << " at " << triple(move.offset));
    CHECK(misplaced < positions.size() / 50);
    CHECK(wrong < positions.size() / 50);  // what a ball shows of an edge may be another surface
  }
}

std::string obj_of(const Move& move) {
  std::string text;
  for (const V3d& p : {V3d(0, 0, 0), V3d(0.93, 0, 0), V3d(0.93, 0.93, 0), V3d(0, 0.93, 0)}) {
    const V3d moved = move(p);
    text += fmt::format("v {:.4f} +{:.4f} {:.4f}\n", moved.x, moved.y, moved.z);
  }
  return text + "f 1 2 3 4\n";
}

double area_of(const Mesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const V3d o(mesh.positions[a]);
    area += 0.5 * (V3d(mesh.positions[b]) - o).cross(V3d(mesh.positions[c]) - o).length();
  }
  return area;
}

TEST_CASE("vertices of an OBJ file keep the digits that the file has", "[scale]") {
  const TempFolder folder;
  const std::string far = obj_of({1, {408201.615, 4080928.035, 12.5}});
  const Scene scene = load_scene(folder.write("far.obj", far));
  CHECK(area_of(scene.meshes.at(0)) == Approx(0.93 * 0.93).epsilon(1e-5));
  bool said = false;
  for (const std::string& warning : scene.warnings) {
    said = said || contains(warning,
                            "vertices 4.08e+06 from the origin: the positions of a dump keep 0.25 "
                            "of a unit there, the scene is 0.93 across");
  }
  CHECK(said);
  const WorldDigits digits = world_digits(scene);
  CHECK(digits.step == 0.25);
  CHECK(digits.across == Approx(0.93));

  // Moved to the origin by a JSON scene around it, it needs no note.
  const Scene moved = load_scene(folder.write("s.json", with_shapes(R"({"shape": "mesh",
      "file": "far.obj", "material": "lamp", "transform": {"translate": [-408201, -4080928, 0]}})")));
  CHECK(area_of(moved.meshes.at(0)) == Approx(0.93 * 0.93).epsilon(1e-5));
  CHECK(moved.space.is_world());
  CHECK(moved.warnings.empty());
  CHECK(moved.meshes[0].positions[0].x == Approx(0.615).margin(1e-4));
  CHECK(moved.meshes[0].positions[0].y == Approx(0.035).margin(1e-4));
}

TEST_CASE("a shape that is tiny beside its distance from the rest is named", "[scale]") {
  const TempFolder folder;
  const Scene scene = load_scene(folder.write(
      "s.json", with_shapes(R"({"shape": "box", "material": "lamp", "min": [-5e6, 0, 0],
                                "max": [5e6, 1e4, 1e4]},
                               {"shape": "box", "name": "hut", "material": "white",
                                "min": [4e6, 0, 0], "max": [4000001, 1, 1]})")));
  REQUIRE(scene.warnings.size() == 1);
  CHECK(
      contains(scene.warnings[0],
               "smaller than 64 steps of a float where it is, so that its form is lost: mesh hut, "
               "1 across, 4e+06 from the middle"));
}

TEST_CASE("a file that is too small for a scene is none where its place makes it larger",
          "[scale]") {
  const TempFolder folder;
  folder.write("tiny.obj", "v 0 0 0\nv 2e-31 0 0\nv 0 2e-31 0\nf 1 2 3\n");
  CHECK(load_failure(folder.write("t.obj", "v 0 0 0\nv 2e-31 0 0\nv 0 2e-31 0\nf 1 2 3\n")).code ==
        ErrorCode::limit);
  const Scene scene = load_scene(folder.write(
      "s.json",
      R"({"shapes": [{"shape": "mesh", "file": "tiny.obj", "transform": {"scale": 1e31}}]})"));
  CHECK(area_of(scene.meshes.at(0)) * std::ldexp(1.0, 2 * scene.space.exponent) ==
        Approx(2).epsilon(1e-6));
}

TEST_CASE("a cylinder that is alone may be as long as any scene", "[scale]") {
  const TempFolder folder;
  for (const double scale : {1e-15, 1.0, 1e15, 1e25, 1e35}) {
    CAPTURE(scale);
    const nlohmann::json shape{{"shape", "cylinder"}, {"material", "white"},
                               {"from", {0, 0, 0}},   {"to", {2 * scale, 0, 0}},
                               {"radius", scale},     {"segments", 4},
                               {"caps", false}};
    const Scene scene = load_scene(folder.write("s.json", with_shapes(shape.dump())));
    CHECK(area_of(scene.meshes.at(0)) * std::ldexp(1.0, 2 * scene.space.exponent) / scale / scale ==
          Approx(4 * std::sqrt(2.0) * 2).epsilon(1e-5));
    for (const Vec3& n : scene.meshes[0].normals) CHECK(n.length() == Approx(1).epsilon(1e-5));
  }
}

TEST_CASE("scenes beyond the range of floats and doubles are refused by name", "[scale]") {
  const TempFolder folder;
  const auto refusal = [&](const Move& move) {
    const Failure failure = load_failure(folder.write("s.json", box_scene(move).dump()));
    CHECK(failure.code == ErrorCode::limit);
    return failure.message;
  };
  CHECK(contains(refusal({1e36, {0, 0, 0}}), "units from the origin, 1e+36 are the most"));
  CHECK(contains(refusal({1e-31, {0, 0, 0}}), "units across, 1e-30 are the least"));
  CHECK(contains(refusal({1e-6, {1e7, 1e7, 0}}), "move it nearer than 1e+12 times its size"));
}

// The ground of a scene may be as large as it likes.
TEST_CASE("a cube on a huge plane has the shadow that it has on a small one", "[scale]") {
  const TempFolder folder;
  const auto scene_of = [&](double half, double tilt) {
    json scene;
    scene["cameras"] = {{{"eye", {0, 2.5, 6}}, {"target", {0, 0.4, 0}}, {"size", {32, 32}}}};
    scene["environment"] = {{"radiance", 1}};
    scene["materials"] = {{{"name", "m"}, {"reflectance", 0.5}}};
    scene["shapes"] = {
        quad("m", {-half, -tilt * half, half}, {2 * half, 2 * tilt * half, 0}, {0, 0, -2 * half}),
        {{"shape", "box"}, {"material", "m"}, {"min", {-0.5, 0, -0.5}}, {"max", {0.5, 1, 0.5}}}};
    return folder.write("s.json", scene.dump());
  };
  const auto picture_of = [&](double half, double tilt, std::uint64_t seed) {
    return picture(load_scene(scene_of(half, tilt)), seed);
  };
  for (const double tilt : {0.0, 0.125}) {
    const std::vector<Rgb> expected = picture_of(64, tilt, 0);
    const double noise = rel_mse(picture_of(64, tilt, 1), expected);
    for (const double half : {1024.0, 1048576.0, 0x1p31, 0x1p34, 0x1p46}) {
      const std::vector<Rgb> found = picture_of(half, tilt, 0);
      // The horizon is nearer where the plane is small: only the lower half of the picture.
      const std::vector<Rgb> lower(found.begin() + 512, found.end()),
          right(expected.begin() + 512, expected.end());
      INFO("half side " << half << ", tilt " << tilt);
      CHECK(rel_mse(lower, right) < noise);
      CHECK(std::abs(mean_of(lower) / mean_of(right) - 1) < 0.01);
    }
  }
  const Scene larger = load_scene(scene_of(1e20, 0));
  REQUIRE(larger.warnings.size() == 1);
  CHECK(contains(larger.warnings[0],
                 "so small beside the scene that it may not be seen: mesh /shapes/1, 1 across"));
}

TEST_CASE("a sphere that is too large to stand on is refused by name", "[scale]") {
  const TempFolder folder;
  const auto scene_of = [&](double radius) {
    json scene;
    scene["cameras"] = {
        {{"eye", {0, 2, 0}}, {"target", {0, 0, -1}}, {"fov", 30}, {"size", {32, 32}}}};
    scene["environment"] = {{"radiance", 1}};
    scene["materials"] = {{{"name", "m"}, {"reflectance", 0.5}}};
    scene["shapes"] = {{{"shape", "sphere"},
                        {"name", "earth"},
                        {"material", "m"},
                        {"center", {0, -radius, 0}},
                        {"radius", radius}}};
    return folder.write("s.json", scene.dump());
  };
  for (const double radius : {10.0, 1e3, 1e4}) {
    INFO(radius);
    const Scene scene = load_scene(scene_of(radius));
    CHECK(mean_of(picture(scene)) == Approx(0.5).epsilon(0.01));
  }
  const Failure failure = load_failure(scene_of(1e9));
  CHECK(failure.code == ErrorCode::limit);
  CHECK(contains(failure.message, "sphere earth: its radius of 1e+09 is 5e+08 times the distance"));
}

}  // namespace
}  // namespace psf::render
