// Mesh files that the JSON scene file includes.
#include "core/error.h"
#include "render/scene/json/parts.h"
#include "render/scene/shapes.h"

namespace psf::render {

void add_mesh_file(const JsonCursor& json, int material, bool flipped,
                   const std::vector<Placement>& placements, JsonLoad& load) {
  const JsonCursor file = json.at("file");
  Scene& scene = load.scene;
  Scene part;
  part.moment = scene.moment;
  try {
    const std::string path = find_file(file.file(), file.text());
    scene.files.push_back(path);
    if (scene.space.exact) {
      part = load_fitting(path, [&](Scene& empty) {
        empty.moment = scene.moment;
        load_mesh_file(path, empty);
      });
    } else {
      load_mesh_file(path, part);
      if (fitting_space(part).exact) scene.wanted.exact = true;
    }
  } catch (const Error& error) {
    throw Error(error.code(), file.where() + ": " + error.what());
  }
  std::vector<Placement> of_part = placements;
  if (scene.space.exact) {
    for (Placement& placement : of_part) placement = part.space.to_world() * placement;
  }
  const int first_material = static_cast<int>(scene.materials.size());
  if (material == kNone) {
    const int first_texture = static_cast<int>(scene.textures.size());
    for (Texture& texture : part.textures) scene.textures.push_back(std::move(texture));
    for (Material m : part.materials) {
      for (int* texture : m.textures()) {
        if (*texture != kNone) *texture += first_texture;
      }
      scene.materials.push_back(std::move(m));
    }
  }
  const bool around_moves = load.moves;
  load.moves = around_moves || !part.animation.empty();
  const auto add = [&](Mesh& mesh, const std::vector<Placement>& copies) {
    mesh.material = material == kNone ? mesh.material + first_material : material;
    if (flipped) flip(mesh);
    add_mesh(json, mesh, copies, load);
  };
  for (Mesh& mesh : part.meshes) add(mesh, of_part);
  for (std::size_t k = 0; k < part.prototypes.size(); ++k) {
    std::vector<Placement> of_instances;
    for (const Instance& instance : part.instances) {
      if (instance.prototype == k) of_instances.emplace_back(instance.placement);
    }
    add(part.prototypes[k], combine(json, of_instances, of_part, scene.space.exact));
  }
  load.moves = around_moves;
  scene.files.insert(scene.files.end(), part.files.begin(), part.files.end());
  scene.animation.insert(scene.animation.end(), part.animation.begin(), part.animation.end());
  for (std::string& warning : part.warnings) scene.warnings.push_back(std::move(warning));
}

}  // namespace psf::render
