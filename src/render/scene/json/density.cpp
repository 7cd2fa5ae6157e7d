// Densities of media in the JSON scene file.
#include <array>

#include "core/error.h"
#include "render/scene/json/parts.h"
#include "render/scene/procedural/densities.h"
#include "render/scene/vdb.h"

namespace psf::render {
namespace {

constexpr std::uint32_t kMaxOctaves = 16;
constexpr std::uint32_t kMaxVoxels = 1024;
constexpr Range kFrequencies{0, 1000, "in [0, 1000]"};

using Density = std::shared_ptr<const DensityGrid>;

Density read_cloud(const JsonCursor& json, const Imath::M44d& to_space) {
  json.check_keys({"kind", "transform", "seed", "radius", "frequency", "amplitude", "edge",
                   "octaves", "voxels"});
  CloudDensity cloud;
  cloud.seed = read_seed(json);
  cloud.radius = real_or(json, "radius", kPositive, cloud.radius);
  cloud.frequency = real_or(json, "frequency", kFrequencies, cloud.frequency);
  cloud.amplitude = real_or(json, "amplitude", kUnitRange, cloud.amplitude);
  cloud.edge = real_or(json, "edge", kPositive, cloud.edge);
  cloud.octaves = integer_or(json, "octaves", kMaxOctaves, cloud.octaves);
  cloud.voxels = integer_or(json, "voxels", kMaxVoxels, cloud.voxels);
  return make_cloud(cloud, to_space);
}

Density read_mist(const JsonCursor& json, const Imath::M44d& to_space) {
  json.check_keys(
      {"kind", "transform", "seed", "min", "max", "frequency", "amplitude", "octaves", "voxels"});
  MistDensity mist;
  mist.seed = read_seed(json);
  const JsonCursor max = json.at("max");
  mist.box = Imath::Box3d(json.at("min").vec3d(), max.vec3d());
  if (!(mist.box.min.x < mist.box.max.x && mist.box.min.y < mist.box.max.y &&
        mist.box.min.z < mist.box.max.z)) {
    max.fail("is not greater than \"min\" along each axis");
  }
  mist.frequency = real_or(json, "frequency", kFrequencies, mist.frequency);
  mist.amplitude = real_or(json, "amplitude", kUnitRange, mist.amplitude);
  mist.octaves = integer_or(json, "octaves", kMaxOctaves, mist.octaves);
  mist.voxels = integer_or(json, "voxels", kMaxVoxels, mist.voxels);
  return make_mist(mist, to_space);
}

Density read_grid(const JsonCursor& json, const Imath::M44d& to_space, Scene& scene) {
  json.check_keys({"kind", "transform", "file", "grid"});
  const JsonCursor file = json.at("file");
  const auto grid = json.find("grid");
  const std::string path = find_file(file.file(), file.text());
  scene.files.push_back(path);
  try {
    return read_vdb(path, grid ? grid->text() : "density", to_space);
  } catch (const Error& error) {
    throw Error(error.code(), file.where() + ": " + error.what());
  }
}

}  // namespace

Density read_density(const JsonCursor& json, Scene& scene) {
  static constexpr std::string_view kKinds[] = {"cloud", "mist", "grid"};
  const std::size_t kind = json.at("kind").choice(kKinds);
  for (const char* key : {"keyframes", "repeat", "scatter"}) {
    if (const auto found = json.find(key)) found->fail("a density stands still, and alone");
  }
  const Placement placement = read_placements(json, scene)[0];
  if (!(std::abs(Imath::M44d(placement).determinant()) > 0)) {
    json.at("transform").fail("makes everything flat");
  }
  // Where everything is does not depend on it.
  if (scene.moment.parts != Moment::Parts::all) return nullptr;
  stop_where_interrupted();
  const Imath::M44d to_space = placement * scene.space.to_local();
  switch (kind) {
    case 0:
      return read_cloud(json, to_space);
    case 1:
      return read_mist(json, to_space);
    default:
      return read_grid(json, to_space, scene);
  }
}

}  // namespace psf::render
