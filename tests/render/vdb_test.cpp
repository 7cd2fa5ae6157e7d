// OpenVDB grids against OpenVDB's own sampling of them, and the error of every grid that is no
// density. The files are written by the tests.
#include "render/scene/vdb.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <random>

#include "density_support.h"
#include "load_support.h"

namespace psf::render {
namespace {

using openvdb::FloatGrid;

template <class Grid>
void write(const std::string& path, std::initializer_list<typename Grid::Ptr> grids) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.write(openvdb::GridCPtrVec(grids.begin(), grids.end()));
}

// Voxels around the origin, in the tree's leaves and as one of its tiles, turned and stretched.
FloatGrid::Ptr test_grid() {
  openvdb::initialize();
  const FloatGrid::Ptr grid = FloatGrid::create(0);
  grid->setName("density");
  FloatGrid::Accessor to = grid->getAccessor();
  std::mt19937 generator(11);
  std::uniform_real_distribution<float> unit;
  for (int k = 0; k < 3000; ++k) {
    const auto at = [&] { return static_cast<int>(unit(generator) * 30) - 17; };
    to.setValue({at(), at(), at()}, unit(generator) * 3);
  }
  grid->tree().fill(openvdb::CoordBBox({16, -16, 0}, {31, -1, 15}), 2);
  const openvdb::math::Transform::Ptr transform =
      openvdb::math::Transform::createLinearTransform(0.25);
  transform->postScale({1, 2, 0.5});
  transform->postRotate(0.4, openvdb::math::Y_AXIS);
  transform->postTranslate({3, -1, 7});
  grid->setTransform(transform);
  return grid;
}

constexpr const char* kScene =
    R"({"media": [{"name": "m", "sigma_s": 1, "density": {"kind": "grid", "file": "a.vdb")";

std::string scene_of(const std::string& keys = "") {
  return kScene + keys +
         R"(}}], "medium": "m", "environment": {"radiance": 1}, "materials": [{"name": "grey"}],
    "shapes": [{"shape": "sphere", "material": "grey", "center": [0, 0, 0], "radius": 1}]})";
}

TEST_CASE("A VDB grid is sampled as OpenVDB samples it, wherever its transform puts it", "[load]") {
  const TempFolder folder;
  const FloatGrid::Ptr grid = test_grid();
  const std::string path = folder.write("a.vdb", "");
  write<FloatGrid>(path, {grid});
  // The scene's space is the file's world, moved and scaled.
  const Imath::M44d to_space =
      Imath::M44d().setScale(2.0) * Imath::M44d().setTranslation(Imath::V3d(1, 2, 3));
  const auto density = read_vdb(path, "density", to_space);
  CHECK(density->most() <= 3);
  const openvdb::tools::GridSampler<FloatGrid, openvdb::tools::BoxSampler> oracle(*grid);
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> unit(-22, 36);
  int inside = 0, on_tile = 0;
  for (int k = 0; k < 20000; ++k) {
    const openvdb::Vec3d voxel(unit(generator), unit(generator), unit(generator));
    const openvdb::Vec3d world = grid->indexToWorld(voxel);
    const double expected{oracle.isSample(voxel)};
    const double found =
        test::density_at(*density, Imath::V3d(world.x(), world.y(), world.z()) * to_space);
    REQUIRE(std::abs(found - expected) < 1e-4);
    inside += expected > 0 ? 1 : 0;
    on_tile += expected == 2 ? 1 : 0;
  }
  CHECK(inside > 2000);
  CHECK(on_tile > 100);
}

TEST_CASE("A scene with a VDB grid knows the file, and its hash the values", "[load][hash]") {
  const TempFolder folder;
  const std::string scene = folder.write("s.json", scene_of());
  const std::string path = folder.write("a.vdb", "");
  FloatGrid::Ptr grid = test_grid();
  write<FloatGrid>(path, {grid});
  const Scene first = load_scene(scene);
  CHECK(std::count(first.files.begin(), first.files.end(), path) == 1);
  CHECK(first.warnings.empty());
  REQUIRE(first.media[0].density != nullptr);
  CHECK(load_scene(scene).hash == first.hash);
  // A placement, and one voxel by a little.
  folder.write("s.json", scene_of(R"(, "transform": {"translate": [0, 0, 0.001]})"));
  const std::string moved = load_scene(scene).hash;
  CHECK(moved != first.hash);
  grid->getAccessor().setValue({20, -10, 7}, 2.00001f);
  write<FloatGrid>(path, {grid});
  CHECK(load_scene(scene).hash != moved);
}

TEST_CASE("An error of a VDB grid names file, grid and remedy", "[load]") {
  const TempFolder folder;
  const std::string scene = folder.write("s.json", scene_of());
  const auto failure = [&] {
    const Failure found = load_failure(scene);
    CHECK(found.code == ErrorCode::bad_input);
    const std::string place = "s.json:1: /media/0/density/file: a.vdb: ";
    CHECK(found.message.substr(0, place.size()) == place);
    return found.message.substr(std::min(place.size(), found.message.size()));
  };
  const Failure missing = load_failure(scene);
  CHECK(missing.code == ErrorCode::io);
  CHECK(missing.message == "s.json:1: /media/0/density/file: a.vdb: no such file");

  const std::string path = folder.write("a.vdb", "this is no grid of anything at all");
  CHECK(failure().substr(0, 27) == "not a VDB file, or damaged ");
  const auto with = [&](const FloatGrid::Ptr& grid) {
    write<FloatGrid>(path, {grid});
    return failure();
  };
  FloatGrid::Ptr grid = test_grid();
  grid->setName("smoke");
  FloatGrid::Ptr other = test_grid();
  other->setName("heat");
  write<FloatGrid>(path, {grid, other});
  const std::string no_grid = failure();
  CHECK((no_grid == "no grid is called \"density\"; it has smoke, heat" ||
         no_grid == "no grid is called \"density\"; it has heat, smoke"));

  openvdb::DoubleGrid::Ptr doubles = openvdb::DoubleGrid::create(0);
  doubles->setName("density");
  write<openvdb::DoubleGrid>(path, {doubles});
  CHECK(failure() == "grid density: has values of the type double; a density is one of floats");
  grid = test_grid();
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  CHECK(with(grid) ==
        "grid density: is a level set, which has distances; store it as a fog volume");
  grid = test_grid();
  grid->getAccessor().setValue({-3, 4, 5}, -0.5f);
  CHECK(with(grid) == "grid density: voxel -3, 4, 5: a density is a finite number >= 0, not -0.5");
  grid->getAccessor().setValue({-3, 4, 5}, std::nanf(""));
  CHECK(with(grid) == "grid density: voxel -3, 4, 5: a density is a finite number >= 0, not nan");
  grid = FloatGrid::create(0.5f);
  grid->setName("density");
  CHECK(with(grid) == "grid density: its background is 0.5; outside of its voxels there must be 0");
  grid = FloatGrid::create(0);
  grid->setName("density");
  CHECK(with(grid) == "grid density: has no active voxel");
  grid->getAccessor().setValue({0, 0, 0}, 1);
  grid->getAccessor().setValue({100000, 100000, 100000}, 1);
  write<FloatGrid>(path, {grid});
  const Failure far = load_failure(scene);
  CHECK(far.code == ErrorCode::limit);
  CHECK(far.message ==
        "s.json:1: /media/0/density/file: a.vdb: grid density: has more than 16777216 cells of 8 "
        "voxels a side; make it coarser");
}

// The library asks for as much memory as damaged sizes say, which the sanitizers end a program for.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_CASE("A VDB file that is cut anywhere is an error of one line", "[load]") {
  const TempFolder folder;
  const std::string scene = folder.write("s.json", scene_of());
  const std::string path = folder.write("a.vdb", "");
  write<FloatGrid>(path, {test_grid()});
  std::ifstream in(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  REQUIRE(bytes.size() > 1000);
  for (std::size_t k = 0; k < 40; ++k) {
    folder.write("a.vdb", bytes.substr(0, bytes.size() * k / 40));
    const Failure found = load_failure(scene);
    CAPTURE(k, found.message);
    CHECK(found.code == ErrorCode::bad_input);
    CHECK(found.message.find('\n') == std::string::npos);
  }
}
#endif

}  // namespace
}  // namespace psf::render
