#include "render/scene/copies.h"

#include <algorithm>
#include <cmath>

#include "render/scene/shapes.h"

namespace psf::render {
namespace {

constexpr std::size_t kLeastTriangles = 16;                   // of a shape
constexpr std::size_t kLeastTogether = std::size_t{1} << 16;  // of all its copies

// Sizes of copies, each to the third power, beside that of the first: what Embree inverts in float.
constexpr double kMostApart = 1e24;

bool alike_in_size(std::span<const Imath::M44d> placements) {
  const double first = std::abs(placements[0].determinant());
  return std::all_of(placements.begin(), placements.end(), [&](const Imath::M44d& placement) {
    const double size = std::abs(placement.determinant());
    return size * kMostApart > first && size < first * kMostApart;
  });
}

// The largest extent along an axis of the placed unit cube's edges, as an exponent of two.
int exponent_of(const Imath::M44d& placement) {
  double largest = 0;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      largest = std::max(largest, std::abs(placement[row][column]));
  }
  return std::ilogb(largest);
}

// The prototype lies around its own origin and has about the size of its copies, and the placements
// make up for that: so it has all digits of a float, wherever the file has it.
void add_instances(Scene& scene, const Mesh& mesh, std::span<const Imath::M44d> placements) {
  const auto number = static_cast<std::uint32_t>(scene.prototypes.size());
  const Imath::Box3d box = bounds_of(mesh);
  const Imath::V3d center = box.isEmpty() ? Imath::V3d(0) : box.center();
  const int exponent = exponent_of(placements[0]);
  const Imath::M44d back =
      Imath::M44d().setScale(std::ldexp(1.0, -exponent)) * Imath::M44d().setTranslation(center);
  scene.instances.reserve(scene.instances.size() + placements.size());
  for (const Imath::M44d& placement : placements)
    scene.instances.push_back({number, Mat4(back * placement)});
  const double size = std::ldexp(1.0, exponent);
  Mesh prototype = mesh;
  for (Vec3& p : prototype.positions) p = Vec3((Imath::V3d(p) - center) * size);
  scene.prototypes.push_back(std::move(prototype));
}

}  // namespace

bool is_instanced(const Scene& scene, const Mesh& mesh, std::span<const Imath::M44d> placements) {
  const std::size_t copies = placements.size();
  const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
  return copies > 1 && copies <= kMaxInstances && mesh.triangles.size() >= kLeastTriangles &&
         mesh.triangles.size() >= (kLeastTogether + copies - 1) / copies &&
         is_black(material.emission) && alike_in_size(placements);
}

void add_copies(Scene& scene, const Mesh& mesh, std::span<const Imath::M44d> placements, bool exact,
                bool instanced) {
  if (instanced) return add_instances(scene, mesh, placements);
  Mesh all;
  all.name = mesh.name;
  all.material = mesh.material;
  all.positions.reserve(mesh.positions.size() * placements.size());
  all.triangles.reserve(mesh.triangles.size() * placements.size());
  for (const Imath::M44d& placement : placements) {
    Mesh copy = mesh;
    if (exact) {
      transform(copy, placement);
    } else {
      transform(copy, Mat4(placement));
    }
    append(all, copy);
  }
  scene.meshes.push_back(std::move(all));
}

Imath::Box3d bounds_of(const Mesh& prototype) {
  Imath::Box3d box;
  for (const Vec3& p : prototype.positions) {
    if (is_finite(p)) box.extendBy(Imath::V3d(p));
  }
  return box;
}

Imath::Box3d bounds_of(const Imath::Box3d& prototype, const Instance& instance) {
  Imath::Box3d box;
  if (prototype.isEmpty()) return box;
  const Imath::M44d placement(instance.placement);
  for (int corner = 0; corner < 8; ++corner) {
    Imath::V3d p;
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = ((corner >> axis) & 1) != 0 ? prototype.max[axis] : prototype.min[axis];
    box.extendBy(p * placement);
  }
  return box;
}

}  // namespace psf::render
