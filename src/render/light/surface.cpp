// What a ray found: positions and normals as exact as the buffers allow.
#include "render/light/surface.h"

#include "render/light/frame.h"

namespace psf::render {

Vec2 direction_to_uv(const Vec3& d) {
  return {0.5f + std::atan2(d.x, -d.z) * (0.5f * kInvPi),
          0.5f + std::asin(std::clamp(d.y, -1.0f, 1.0f)) * kInvPi};
}

Vec3 uv_to_direction(const Vec2& uv) {
  const float longitude = (uv.x - 0.5f) * 2 * kPi, latitude = (uv.y - 0.5f) * kPi;
  const float r = std::cos(latitude);
  return {r * std::sin(longitude), std::sin(latitude), -r * std::cos(longitude)};
}

Vec3 Surface::bent_into_sight(const Vec3& normal, const Vec3& geometric_normal,
                              const Vec3& direction) {
  // An interpolated normal may face away from the viewer at silhouettes.
  constexpr float kLeastCosine = 1e-3f;
  const float cosine = -dot(normal, direction);
  if (cosine >= kLeastCosine || normal == geometric_normal) return normal;
  return normalize(normal - direction * (kLeastCosine - cosine));
}

Shapes::Shapes(const Scene& scene) {
  reliefs_.reserve(scene.materials.size());
  for (const Material& m : scene.materials) reliefs_.emplace_back(m, scene);
  const auto relief = [&](int material) {
    const Relief& found = reliefs_[static_cast<std::size_t>(material)];
    return found.flat() ? nullptr : &found;
  };
  meshes_.reserve(scene.meshes.size());
  for (const Mesh& m : scene.meshes) {
    meshes_.push_back({m.positions.data(), m.normals.empty() ? nullptr : m.normals.data(),
                       m.uvs.empty() ? nullptr : m.uvs.data(), m.triangles.data(), m.material,
                       kNone, relief(m.material)});
  }
  spheres_.reserve(scene.spheres.size());
  for (const Sphere& s : scene.spheres) {
    spheres_.push_back({s.center, s.radius, s.material, kNone, relief(s.material)});
  }
}

Surface Shapes::surface(const Hit& hit, const Vec3& direction) const {
  Surface s;
  Vec3 smooth;  // the shading normal without relief
  if (hit.geometry < meshes_.size()) {
    const MeshView& mesh = meshes_[hit.geometry];
    const auto& [a, b, c] = mesh.triangles[hit.primitive];
    const Vec3 &p0 = mesh.positions[a], &p1 = mesh.positions[b], &p2 = mesh.positions[c];
    const float w = 1 - hit.u - hit.v;
    // Weights of the corners, not origin + t * direction: the error does not grow with the
    // distance.
    s.position = p0 * w + p1 * hit.u + p2 * hit.v;
    s.offset = std::max(max_abs(p0), std::max(max_abs(p1), max_abs(p2))) * kOffsetScale;
    const TriangleNormal flat(p1 - p0, p2 - p0);
    s.geometric_normal = flat.size > 0 ? flat.normal : -direction;
    s.normal = s.geometric_normal;
    if (mesh.normals != nullptr) {
      const Vec3 sum = mesh.normals[a] * w + mesh.normals[b] * hit.u + mesh.normals[c] * hit.v;
      const float sum_sq = length_sq(sum);
      if (sum_sq > 1e-12f) s.normal = sum * (1 / std::sqrt(sum_sq));
    }
    s.uv = mesh.uvs != nullptr ? mesh.uvs[a] * w + mesh.uvs[b] * hit.u + mesh.uvs[c] * hit.v
                               : Vec2(hit.u, hit.v);
    smooth = s.normal;
    if (mesh.relief != nullptr && mesh.uvs != nullptr) {
      const Chart chart = Chart::of_triangle(p1 - p0, p2 - p0, mesh.uvs[b] - mesh.uvs[a],
                                             mesh.uvs[c] - mesh.uvs[a]);
      s.normal = mesh.relief->normal(smooth, chart, s.uv);
    }
    s.material = mesh.material;
    s.emitter = mesh.emitter;
  } else {
    const SphereView& sphere = spheres_[hit.primitive];
    s.geometric_normal = normalize(hit.normal);
    s.normal = s.geometric_normal;
    s.position = sphere.center + s.normal * sphere.radius;
    s.offset = (max_abs(sphere.center) + sphere.radius) * kOffsetScale;
    s.uv = direction_to_uv(s.normal);
    smooth = s.normal;
    if (sphere.relief != nullptr) {
      const Chart chart = Chart::of_sphere(smooth, sphere.radius);
      s.normal = sphere.relief->normal(smooth, chart, s.uv);
    }
    s.material = sphere.material;
    s.emitter = sphere.emitter;
  }
  s.front = dot(direction, s.geometric_normal) < 0;
  if (!s.front) s.geometric_normal = -s.geometric_normal;
  if (dot(smooth, s.geometric_normal) < 0) s.normal = -s.normal;
  s.normal = Surface::bent_into_sight(s.normal, s.geometric_normal, direction);
  return s;
}

}  // namespace psf::render
