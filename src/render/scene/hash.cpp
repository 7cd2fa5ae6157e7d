// The hash over all of a scene that shapes the picture.
#include <OpenImageIO/hash.h>
#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "render/scene/density_grid.h"
#include "render/scene/load_parts.h"
#include "render/scene/motion.h"

namespace psf::render {
namespace {

// Collects 64-bit numbers: small values as they are, arrays as their fingerprint (FarmHash, whose
// fingerprints are the same on all machines and in all its versions).
class Digest {
 public:
  void add(std::uint64_t value) { words_.push_back(value); }
  void add(float value) { add(std::uint64_t{std::bit_cast<std::uint32_t>(value)}); }
  void add(int value) { add(static_cast<std::uint64_t>(value)); }
  void add(const Vec3& v) {
    add(v.x);
    add(v.y);
    add(v.z);
  }
  void add(const Rgb& c) { add(Vec3(c.x, c.y, c.z)); }
  template <typename T>
  void add_array(const std::vector<T>& values) {
    add(std::uint64_t{values.size()});
    if (!values.empty()) add_values(std::span<const T>(values));
  }
  template <typename T, std::size_t N>
  void add_values(std::span<T, N> values) {
    add(std::uint64_t{OIIO::farmhash::Fingerprint64(
        static_cast<const char*>(static_cast<const void*>(values.data())), values.size_bytes())});
  }
  [[nodiscard]] std::string text() const {
    const auto hash = OIIO::farmhash::Fingerprint128(
        static_cast<const char*>(static_cast<const void*>(words_.data())),
        words_.size() * sizeof(std::uint64_t));
    return fmt::format("{:016x}{:016x}", OIIO::farmhash::Uint128High64(hash),
                       OIIO::farmhash::Uint128Low64(hash));
  }

 private:
  std::vector<std::uint64_t> words_;
};

void add(Digest& digest, const Texture& texture) {
  digest.add(std::uint64_t{texture.width()});
  digest.add(std::uint64_t{texture.height()});
  std::vector<Rgb> row(texture.width());
  for (std::size_t y = 0; y < texture.height(); ++y) {
    for (std::size_t x = 0; x < texture.width(); ++x) row[x] = texture.texel(x, y);
    digest.add_array(row);
  }
}

void add(Digest& digest, const Material& m) {
  digest.add(static_cast<int>(m.kind));
  digest.add(m.reflectance);
  digest.add(m.reflectance_texture);
  if (m.kind == MaterialKind::gloss) digest.add(m.specular);
  digest.add(m.roughness);
  digest.add(m.metalness);
  digest.add(m.roughness_metalness_texture);
  digest.add(m.ior);
  if (m.interior != kNone) digest.add(m.interior);
  digest.add(int{m.two_sided});
  digest.add(int{m.emits_two_sided});
  digest.add(m.emission);
  digest.add(m.emission_texture);
  const bool metal =
      m.kind == MaterialKind::conductor || (m.kind == MaterialKind::coat && m.metalness > 0);
  if (metal && m.multiple_scattering) digest.add(1);
  if (m.normal_texture != kNone) {
    digest.add(2);
    digest.add(m.normal_texture);
    digest.add(m.normal_scale);
  }
  if (m.bump_texture != kNone) {
    digest.add(3);
    digest.add(m.bump_texture);
    digest.add(m.bump_height);
  }
  if (m.clearcoat > 0) {
    digest.add(4);
    digest.add(m.clearcoat);
    digest.add(m.clearcoat_texture);
    digest.add(m.clearcoat_roughness);
    digest.add(m.clearcoat_roughness_texture);
  }
  if (m.opacity < 1 || m.opacity_texture != kNone) {
    digest.add(m.opacity);
    digest.add(m.opacity_texture);
    digest.add(m.opacity_cutoff);
  }
}

void add(Digest& digest, const DensityGrid& grid) {
  for (int axis = 0; axis < 3; ++axis) digest.add(grid.size()[axis]);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column)
      digest.add(std::bit_cast<std::uint64_t>(grid.to_cells()[row][column]));
  }
  for (std::size_t c = 0; c < grid.cells().size(); ++c) {
    const DensityGrid::Cell& cell = grid.cells()[c];
    if (!(cell.most > 0)) continue;
    digest.add(std::uint64_t{c});
    digest.add(cell.most);
    if (cell.values != nullptr) digest.add_values(std::span(*cell.values));
  }
}

void add(Digest& digest, const Medium& medium) {
  digest.add(medium.sigma_a);
  digest.add(medium.sigma_s);
  digest.add(medium.g);
  if (medium.density != nullptr) add(digest, *medium.density);
}

void add(Digest& digest, const Mesh& mesh) {
  digest.add_array(mesh.positions);
  digest.add_array(mesh.normals);
  digest.add_array(mesh.uvs);
  if (!mesh.tangents.empty()) digest.add_array(mesh.tangents);
  digest.add_array(mesh.triangles);
  digest.add(mesh.material);
  for (const MeshStep& step : mesh.motion) {
    digest.add_array(step.positions);
    digest.add_array(step.normals);
  }
}

void add(Digest& digest, const Sphere& sphere) {
  digest.add(sphere.center);
  digest.add(sphere.radius);
  digest.add(sphere.material);
  if (!sphere.motion.empty()) digest.add_array(sphere.motion);
}

void add(Digest& digest, const Curves& curves) {
  digest.add_array(curves.points);
  digest.add_array(curves.segments);
  digest.add(curves.material);
}

void add(Digest& digest, const Light& light) {
  digest.add(static_cast<int>(light.kind));
  digest.add(light.position);
  digest.add(light.direction);
  digest.add(light.intensity);
  digest.add(light.cos_inner);
  digest.add(light.cos_outer);
  digest.add(light.angle);
}

void add(Digest& digest, const Camera& camera) {
  digest.add(camera.eye);
  digest.add(camera.target);
  digest.add(camera.up);
  digest.add(camera.fov);
  digest.add(std::uint64_t{camera.width});
  digest.add(std::uint64_t{camera.height});
  digest.add(camera.lens_radius);
  digest.add(camera.focus_distance);
  if (!camera.motion.empty()) digest.add_array(camera.motion);
}

template <typename T>
void add_all(Digest& digest, const std::vector<T>& items) {
  digest.add(std::uint64_t{items.size()});
  for (const T& item : items) add(digest, item);
}

}  // namespace

std::string hash_of(const Scene& scene) {
  Digest digest;
  add_all(digest, scene.textures);
  add_all(digest, scene.materials);
  // Scenes without media have the hash that they had before there were any.
  if (!scene.media.empty()) {
    add_all(digest, scene.media);
    digest.add(scene.medium);
  }
  add_all(digest, scene.meshes);
  add_all(digest, scene.spheres);
  if (!scene.instances.empty()) {
    add_all(digest, scene.prototypes);
    digest.add_array(scene.instances);
  }
  if (!scene.curves.empty()) add_all(digest, scene.curves);
  add_all(digest, scene.lights);
  digest.add(scene.environment.radiance);
  digest.add(scene.environment.texture);
  digest.add(scene.environment.rotation);
  add_all(digest, scene.cameras);
  if (!scene.space.is_world()) {
    for (int axis = 0; axis < 3; ++axis)
      digest.add(std::bit_cast<std::uint64_t>(scene.space.origin[axis]));
    digest.add(scene.space.exponent);
  }
  if (!scene.animation.empty()) digest.add_array(scene.animation);
  if (anything_moves(scene)) {
    for (const Camera& camera : scene.cameras) {
      digest.add(camera.shutter.open);
      digest.add(camera.shutter.close);
    }
  }
  return digest.text();
}

}  // namespace psf::render
