// What a ray found: positions and normals as exact as the buffers allow.
#include "render/light/surface.h"

#include "render/light/frame.h"
#include "render/light/integrator.h"
#include "render/scene/copies.h"
#include "render/scene/motion.h"

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

namespace {

// As kOffsetScale, for what rounding of squared lengths moves a point.
constexpr float kSquaresScale = 0x1p-22f;

// The largest coordinate that takes part in the way of a point of a prototype into the scene, and
// of a ray from there back into the prototype's space, which Embree takes in float.
float largest_on_the_way(const Imath::Box3d& prototype, const Instance& instance) {
  const Imath::M44d placement(instance.placement);
  const Imath::M44d back = placement.inverse();
  const auto through = [](const Imath::M44d& m, const Imath::V3d& p) {
    Imath::V3d sum;
    for (int axis = 0; axis < 3; ++axis) {
      sum[axis] = std::abs(m[3][axis]);
      for (int row = 0; row < 3; ++row) sum[axis] += std::abs(m[row][axis]) * p[row];
    }
    return sum;
  };
  Imath::V3d corner;
  for (int axis = 0; axis < 3; ++axis)
    corner[axis] = std::max(std::abs(prototype.min[axis]), std::abs(prototype.max[axis]));
  Imath::M44d linear = placement;
  for (int axis = 0; axis < 3; ++axis) linear[3][axis] = 0;
  const Imath::V3d placed = through(placement, corner);
  const Imath::V3d returned = through(linear, through(back, placed));
  return static_cast<float>(
      std::max({placed.x, placed.y, placed.z, returned.x, returned.y, returned.z}));
}

// For normals as row vectors, the inverse transposed; scaled, so that it fits in floats.
Mat4 normal_placement(const Instance& instance) {
  const Imath::M44d m = Imath::M44d(instance.placement).inverse().transposed();
  double largest = 0;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      largest = std::max(largest, std::abs(m[row][column]));
  }
  Mat4 scaled;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      scaled[row][column] = static_cast<float>(m[row][column] / largest);
  }
  return scaled;
}

}  // namespace

Surface Surface::in_medium(const Ray& ray, int medium, int material) {
  Surface s;
  s.position = s.rest = ray.origin;
  s.geometric_normal = s.normal = -ray.direction;
  s.uv = Vec2(0, 0);
  s.offset = 0;
  s.material = material;
  s.emitter = kNone;
  s.front = true;
  s.time = ray.time;
  s.medium = medium;
  return s;
}

Shapes::Shapes(const Scene& scene) {
  reliefs_.reserve(scene.materials.size());
  for (const Material& m : scene.materials) reliefs_.emplace_back(m, scene);
  const auto relief = [&](int material) {
    const Relief& found = reliefs_[static_cast<std::size_t>(material)];
    return found.flat() ? nullptr : &found;
  };
  const auto view = [&](const Mesh& m) -> MeshView {
    return {m.positions.data(),
            m.normals.empty() ? nullptr : m.normals.data(),
            m.uvs.empty() ? nullptr : m.uvs.data(),
            m.triangles.data(),
            m.material,
            kNone,
            &m,
            relief(m.material)};
  };
  meshes_.reserve(scene.meshes.size());
  for (const Mesh& m : scene.meshes) meshes_.push_back(view(m));
  std::vector<Imath::Box3d> boxes;
  for (const Mesh& m : scene.prototypes) {
    prototypes_.push_back(view(m));
    boxes.push_back(bounds_of(m));
  }
  instances_.reserve(scene.instances.size());
  for (const Instance& i : scene.instances) {
    instances_.push_back({i.prototype, largest_on_the_way(boxes[i.prototype], i) * kOffsetScale,
                          i.placement, normal_placement(i)});
  }
  spheres_.reserve(scene.spheres.size());
  for (const Sphere& s : scene.spheres) {
    spheres_.push_back({s.center, s.radius, s.material, kNone, &s, relief(s.material)});
  }
  curves_.reserve(scene.curves.size());
  for (const Curves& c : scene.curves)
    curves_.push_back({c.points.data(), c.segments.data(), c.material});
}

const Relief* Shapes::on_mesh(const MeshView& mesh, const Hit& hit, const Vec3& direction,
                              Surface& s, Chart& chart) {
  const auto& [a, b, c] = mesh.triangles[hit.primitive];
  Vec3 p0 = mesh.positions[a], p1 = mesh.positions[b], p2 = mesh.positions[c];
  const bool moves = !mesh.mesh->motion.empty();
  if (moves) {
    const float still = TriangleNormal(p1 - p0, p2 - p0).size;
    p0 = position_at(*mesh.mesh, a, s.time);
    p1 = position_at(*mesh.mesh, b, s.time);
    p2 = position_at(*mesh.mesh, c, s.time);
    s.stretch = TriangleNormal(p1 - p0, p2 - p0).size / still;
  }
  const float w = 1 - hit.u - hit.v;
  // Weights of the corners, not origin + t * direction: the error does not grow with the
  // distance.
  s.position = p0 * w + p1 * hit.u + p2 * hit.v;
  s.offset = std::max(max_abs(p0), std::max(max_abs(p1), max_abs(p2))) * kOffsetScale;
  const TriangleNormal flat(p1 - p0, p2 - p0);
  s.geometric_normal = flat.size > 0 ? flat.normal : -direction;
  s.normal = s.geometric_normal;
  if (mesh.normals != nullptr) {
    const auto normal = [&](std::uint32_t i) {
      return moves ? normal_at(*mesh.mesh, i, s.time) : mesh.normals[i];
    };
    const Vec3 sum = normal(a) * w + normal(b) * hit.u + normal(c) * hit.v;
    const float sum_sq = length_sq(sum);
    if (sum_sq > 1e-12f) s.normal = sum * (1 / std::sqrt(sum_sq));
  }
  s.uv = mesh.uvs != nullptr ? mesh.uvs[a] * w + mesh.uvs[b] * hit.u + mesh.uvs[c] * hit.v
                             : Vec2(hit.u, hit.v);
  s.material = mesh.material;
  s.emitter = mesh.emitter;
  s.primitive = hit.primitive;
  const std::vector<Vec3>& rest = mesh.mesh->rest;
  s.rest = rest.empty() ? s.position : rest[a] * w + rest[b] * hit.u + rest[c] * hit.v;
  if (mesh.relief == nullptr || mesh.uvs == nullptr) return nullptr;
  // Those of a file hold where its mesh stands still; heights need lengths as well.
  const std::vector<Imath::V4f>& tangents = mesh.mesh->tangents;
  if (!tangents.empty() && !moves && !mesh.relief->has_heights()) {
    const Imath::V4f along = tangents[a] * w + tangents[b] * hit.u + tangents[c] * hit.v;
    chart = Chart::of_tangent(s.normal, {along.x, along.y, along.z}, along.w < 0 ? -1.0f : 1.0f);
    return mesh.relief;
  }
  chart =
      Chart::of_triangle(p1 - p0, p2 - p0, mesh.uvs[b] - mesh.uvs[a], mesh.uvs[c] - mesh.uvs[a]);
  return mesh.relief;
}

const Relief* Shapes::on_instance(const Hit& hit, const Vec3& direction, Surface& s,
                                  Chart& chart) const {
  const InstanceView& instance = instances_[hit.instance];
  const Relief* relief = on_mesh(prototypes_[instance.prototype], hit, direction, s, chart);
  s.rest = s.position = s.position * instance.placement;
  s.offset = instance.offset;
  const bool interpolated = s.normal != s.geometric_normal;
  const auto placed = [&](const Vec3& normal) {
    Vec3 turned;
    instance.normal_placement.multDirMatrix(normal, turned);
    return normalize(turned);
  };
  s.geometric_normal = placed(s.geometric_normal);
  s.normal = interpolated ? placed(s.normal) : s.geometric_normal;
  if (relief != nullptr) {
    const Chart before = chart;
    instance.placement.multDirMatrix(before.by_u, chart.by_u);
    instance.placement.multDirMatrix(before.by_v, chart.by_v);
  }
  return relief;
}

const Relief* Shapes::on_sphere(const Hit& hit, Surface& s, Chart& chart) const {
  const SphereView& sphere = spheres_[hit.primitive];
  s.geometric_normal = normalize(hit.normal);
  s.normal = s.geometric_normal;
  Ball ball{sphere.center, sphere.radius};
  if (!sphere.sphere->motion.empty()) ball = ball_at(sphere.sphere->motion, s.time);
  s.position = ball.center + s.normal * ball.radius;
  s.offset = (max_abs(ball.center) + ball.radius) * kOffsetScale;
  const std::optional<Ball>& rest = sphere.sphere->rest;
  s.rest = rest ? rest->center + s.normal * rest->radius : s.position;
  s.uv = direction_to_uv(s.normal);
  s.material = sphere.material;
  s.emitter = sphere.emitter;
  if (sphere.relief != nullptr) chart = Chart::of_sphere(s.normal, ball.radius);
  return sphere.relief;
}

void Shapes::on_curve(const CurvesView& curves, const Hit& hit, Surface& s) {
  const std::uint32_t first = curves.segments[hit.primitive];
  const CurvePoint &from = curves.points[first], &to = curves.points[first + 1];
  s.geometric_normal = normalize(hit.normal);
  s.normal = s.geometric_normal;
  // The normal goes through the centre of the ball, of those along the segment, that touches the
  // surface here: (place - centre(t)) . axis = radius(t) slope, with centre and radius linear in t.
  const Vec3 axis = to.position - from.position;
  const float length = std::sqrt(length_sq(axis)), widening = to.radius - from.radius;
  const float slope = length > 0 ? -widening / length : 0;
  const float cosine_sq = 1 - slope * slope;
  float t = from.radius > to.radius ? 0 : 1;  // one ball within the other
  if (length > 0 && cosine_sq > 0) {
    const float along = dot(hit.place - from.position, axis) / length;
    t = std::clamp((along - from.radius * slope) / (length * cosine_sq), 0.0f, 1.0f);
  }
  const float radius = from.radius + widening * t;
  s.rest = s.position = from.position + axis * t + s.normal * radius;
  s.offset =
      (std::max(max_abs(from.position), max_abs(to.position)) + std::max(from.radius, to.radius)) *
      kOffsetScale;
  // Embree takes squares of lengths along a segment off each other to find those across it.
  const float mean_radius = (from.radius + to.radius) / 2;
  if (mean_radius > 0) s.offset += length * length / mean_radius * kSquaresScale;
  s.uv = {t, 0};
  s.material = curves.material;
  s.emitter = kNone;
  s.on_curve = true;
}

Surface Shapes::surface(const Hit& hit, const Vec3& direction, float time) const {
  Surface s;
  s.time = time;
  const Relief* relief = nullptr;
  Chart chart;
  if (hit.instance != Hit::kNoInstance) {
    relief = on_instance(hit, direction, s, chart);
  } else if (hit.geometry < meshes_.size()) {
    relief = on_mesh(meshes_[hit.geometry], hit, direction, s, chart);
  } else if (hit.geometry == meshes_.size()) {
    relief = on_sphere(hit, s, chart);
  } else {
    on_curve(curves_[hit.geometry - meshes_.size() - 1], hit, s);
  }
  s.front = dot(direction, s.geometric_normal) < 0;
  if (!s.front) s.geometric_normal = -s.geometric_normal;
  const Vec3 smooth = s.normal;
  if (relief != nullptr) s.normal = relief->normal(smooth, chart, s.uv);
  if (dot(smooth, s.geometric_normal) < 0) s.normal = -s.normal;
  s.normal = Surface::bent_into_sight(s.normal, s.geometric_normal, direction);
  return s;
}

}  // namespace psf::render
