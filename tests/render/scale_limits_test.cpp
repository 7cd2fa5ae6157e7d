// What is too large beside the rest of a scene: refused, or of finite light all the same.
#include <cmath>

#include "analytic_support.h"
#include "load_support.h"

namespace psf::render {
namespace {

using namespace test;  // NOLINT: the set-up that these tests share

std::string strand_scene(const std::string& strand, const std::string& more = "") {
  return R"({"cameras": [{"name": "c", "eye": [0, 0, 5], "target": [0, 0, 0], "size": [8, 8]}],
      "environment": {"radiance": 1}, "materials": [{"name": "w"}], "shapes": [{"shape": "curves",
      "name": "rope", "material": "w", "segments": 1, "strands": [[)" +
         strand + "]]}" + more + "]}";
}

bool finite(const Rgb& c) {
  return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z);
}

}  // namespace

TEST_CASE("Curves whose segments are too short for their radius are refused", "[load]") {
  const auto said = [](const std::string& strand) {
    const TempFolder folder;
    const std::string message = load_failure(folder.write("s.json", strand_scene(strand))).message;
    CHECK(!contains(message, "\n"));
    return message;
  };
  for (const std::string radius : {"1e16", "1e20", "1e30", "1e35"}) {
    const std::string message = said("[-3, 0, 0, " + radius + "], [3, 0, 0, " + radius + "]");
    CAPTURE(radius, message);
    CHECK(contains(message, "s.json: curves rope: the segment from point 0 is 6 long, "));
    CHECK(contains(message, "leave points out"));
  }
  CHECK(
      contains(said("[0, 0, 0, 1], [1, 0, 0, 1], [1, 1e-12, 0, 1]"), "from point 1 is 1e-12 long"));
  CHECK(said("[-3, 0, 0, 1e12], [3, 0, 0, 1e12]").empty());
  CHECK(said("[0, 0, 0, 1e-3], [1e-4, 0, 0, 1e-3]").empty());
  // One ball within the other.
  CHECK(said("[-3, 0, 0, 1e30], [3, 0, 0, 1e20]").empty());
}

TEST_CASE("A curve as long as it is thick hides the sky at any size") {
  for (const std::string r : {"1e3", "1e12", "1e25", "1e30"}) {
    const TempFolder folder;
    const Scene scene = load_scene(folder.write(
        "s.json", strand_scene("[-" + r + ", 0, 0, " + r + "], [" + r + ", 0, 0, " + r + "]")));
    const Vec3 eye = scene.cameras.at(0).eye;
    const auto integrator = make(scene, "path");
    for (const Vec3& along : {Vec3(0, 0, -1), Vec3(0.8f, 0, -0.6f), Vec3(0.6f, 0.8f, 0)}) {
      const PathRecord record = trace(*integrator, {eye, along}, SamplerKind::sobol, 0, 0);
      CAPTURE(r, along);
      CHECK(record.has_vertex);
      CHECK(pixel(record).y == 0);
    }
  }
}

TEST_CASE("Light paths near a camera in a scene that is 1e25 times as large give finite light") {
  const std::string floor =
      R"(, {"shape": "quad", "material": "w", "origin": [-5, -2, -5], "u": [0, 0, 10], "v": [10, 0, 0]})";
  const TempFolder folder;
  const Scene scene = load_scene(
      folder.write("s.json", strand_scene("[-1e25, 0, 0, 1e25], [1e25, 0, 0, 1e25]", floor)));
  const Vec3 eye = scene.cameras.at(0).eye, down(0, -0.6f, -0.8f);
  for (const char* name : {"path", "vpl", "photon"}) {
    const auto integrator = make(scene, name);
    for (std::uint64_t i = 0; i < 64; ++i) {
      const PathRecord record = trace(*integrator, {eye, down}, SamplerKind::sobol, 0, i);
      CAPTURE(name, i, record.contribution);
      CHECK(finite(record.contribution));
      CHECK(finite(record.unfiltered));
    }
  }
}

}  // namespace psf::render
