#include "render/scene/volumes.h"

#include <fmt/format.h>

namespace psf::render {

std::string volume_in_use(const Scene& scene) {
  if (scene.medium != kNone) {
    const Medium& medium = scene.media[static_cast<std::size_t>(scene.medium)];
    return fmt::format("the medium \"{}\" everywhere", medium.name);
  }
  std::string found;
  const auto look = [&](const char* shape, const std::string& name, int material) {
    const Material& of = scene.materials[static_cast<std::size_t>(material)];
    if (!found.empty() || of.kind != MaterialKind::volume) return;
    const std::string called = name.empty() ? "" : fmt::format(" \"{}\"", name);
    found = fmt::format("the {}{} of the material \"{}\", a volume", shape, called, of.name);
  };
  for (const Mesh& mesh : scene.meshes) {
    if (!mesh.triangles.empty()) look("mesh", mesh.name, mesh.material);
  }
  for (const Instance& instance : scene.instances) {
    const Mesh& prototype = scene.prototypes[instance.prototype];
    look("mesh", prototype.name, prototype.material);
  }
  for (const Sphere& sphere : scene.spheres) look("sphere", sphere.name, sphere.material);
  for (const Curves& curves : scene.curves) look("curves", curves.name, curves.material);
  return found;
}

}  // namespace psf::render
