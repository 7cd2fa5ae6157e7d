#include "render/scene/shapes.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/error.h"

namespace psf::render {
namespace {

// Two triangles of vertices a, b, c, d, counter-clockwise seen from the front.
void add_face(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

// A face with corners of its own.
void add_face(Mesh& mesh, const std::array<Vec3, 4>& corners, const std::array<Vec2, 4>& uvs) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
  mesh.uvs.insert(mesh.uvs.end(), uvs.begin(), uvs.end());
  add_face(mesh, first, first + 1, first + 2, first + 3);
}

std::array<Vec2, 4> unit_square() {
  return {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
}

float angle_of(std::uint32_t k, std::uint32_t segments) {
  return 2 * std::numbers::pi_v<float> * static_cast<float>(k) / static_cast<float>(segments);
}

// Also where squares of it are no floats; such a scene is loaded again in a unit of its own.
template <class V>
float length_of(const V& v) {
  const float narrow = v.length();
  if (std::isfinite(narrow)) return narrow;
  double sum = 0;
  for (int axis = 0; axis < static_cast<int>(V::dimensions()); ++axis) {
    sum += double{v[axis]} * double{v[axis]};
  }
  return static_cast<float>(std::sqrt(sum));
}

}  // namespace

Mesh make_quad(const Vec3& origin, const Vec3& u, const Vec3& v) {
  Mesh mesh;
  add_face(mesh, {origin, origin + u, origin + u + v, origin + v}, unit_square());
  return mesh;
}

Mesh make_box(const Vec3& min, const Vec3& max) {
  Mesh mesh;
  const Vec3 size = max - min;
  const Vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  const auto face = [&](const Vec3& o, const Vec3& u, const Vec3& v) {
    add_face(mesh, {o, o + u, o + u + v, o + v}, unit_square());
  };
  face(min + z, x, y);       // +z
  face(min + x, -x, y);      // -z
  face(min + x + z, -z, y);  // +x
  face(min, z, y);           // -x
  face(min + y + z, x, -z);  // +y
  face(min, x, z);           // -y
  return mesh;
}

Mesh make_lathe(std::span<const Vec2> profile, std::uint32_t segments) {
  Mesh mesh;
  float length = 0;
  for (std::size_t i = 1; i < profile.size(); ++i) length += length_of(profile[i] - profile[i - 1]);
  float done = 0;
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const Vec2 &low = profile[i - 1], &high = profile[i];
    const Vec2 along = high - low;
    const float step = length_of(along);
    if (step == 0) continue;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::uint32_t k = 0; k <= segments; ++k) {
      // The last ring point is the first again, not its rounding.
      const float angle = k == segments ? 0 : angle_of(k, segments);
      const float c = std::cos(angle), s = -std::sin(angle);
      const float u = static_cast<float>(k) / static_cast<float>(segments);
      for (const Vec2& point : {low, high}) {
        mesh.positions.emplace_back(point.x * c, point.y, point.x * s);
        mesh.normals.push_back(Vec3(along.y * c, -along.x, along.y * s) / step);
      }
      mesh.uvs.emplace_back(u, done / length);
      mesh.uvs.emplace_back(u, (done + step) / length);
    }
    done += step;
    for (std::uint32_t k = 0; k < segments; ++k) {
      const std::uint32_t a = first + 2 * k;  // low, high, next low, next high; x turns toward -z
      if (low.x != 0) mesh.triangles.push_back({a, a + 2, a + 3});
      if (high.x != 0) mesh.triangles.push_back({a, a + 3, a + 1});
    }
  }
  return mesh;
}

Mesh make_cylinder(const Vec3& from, const Vec3& to, float from_radius, float to_radius,
                   std::uint32_t segments, bool caps) {
  const Vec3 axis = to - from;
  const float height = length_of(axis);
  std::vector<Vec2> profile;
  if (caps && from_radius > 0) profile.emplace_back(0.0f, 0.0f);
  profile.emplace_back(from_radius, 0.0f);
  profile.emplace_back(to_radius, height);
  if (caps && to_radius > 0) profile.emplace_back(0.0f, height);
  Mesh mesh = make_lathe(profile, segments);

  const Vec3 y = axis / height;
  const Vec3 other = std::abs(y.x) < 0.5f ? Vec3(1, 0, 0) : Vec3(0, 0, 1);
  const Vec3 z = cross(other, y).normalized();
  const Vec3 x = cross(y, z);
  transform(mesh,
            Mat4(x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, from.x, from.y, from.z, 1));
  return mesh;
}

Mesh make_arch(const Arch& arch) {
  Mesh mesh;
  const float half = arch.width / 2, opening = arch.span / 2, z = arch.depth / 2;
  // Outline of the bottom from left to right: pier, opening, pier.
  std::vector<Vec2> bottom;
  if (half > opening) bottom.emplace_back(-half, 0.0f);
  for (std::uint32_t k = 0; k <= arch.segments; ++k) {
    const float angle = angle_of(k, 2 * arch.segments);
    const bool end = k == 0 || k == arch.segments;
    bottom.emplace_back(k == arch.segments ? opening : -opening * std::cos(angle),
                        end ? 0.0f : arch.rise * std::sin(angle));
  }
  if (half > opening) bottom.emplace_back(half, 0.0f);

  const auto strip = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                         const Vec2& uv_size) {
    add_face(mesh, {a, b, c, d}, {Vec2(0, 0), Vec2(uv_size.x, 0), uv_size, Vec2(0, uv_size.y)});
  };
  for (std::size_t i = 1; i < bottom.size(); ++i) {
    const Vec2 p = bottom[i - 1], q = bottom[i];
    const float top = arch.height;
    add_face(mesh, {Vec3(p.x, p.y, z), Vec3(q.x, q.y, z), Vec3(q.x, top, z), Vec3(p.x, top, z)},
             {p, q, Vec2(q.x, top), Vec2(p.x, top)});
    add_face(mesh, {Vec3(q.x, q.y, -z), Vec3(p.x, p.y, -z), Vec3(p.x, top, -z), Vec3(q.x, top, -z)},
             {q, p, Vec2(p.x, top), Vec2(q.x, top)});
    strip({p.x, p.y, -z}, {q.x, q.y, -z}, {q.x, q.y, z}, {p.x, p.y, z},
          {length_of(q - p), arch.depth});
  }
  const float h = arch.height;
  strip({-half, h, z}, {half, h, z}, {half, h, -z}, {-half, h, -z}, {arch.width, arch.depth});
  strip({half, 0, z}, {half, 0, -z}, {half, h, -z}, {half, h, z}, {arch.depth, h});
  strip({-half, 0, -z}, {-half, 0, z}, {-half, h, z}, {-half, h, -z}, {arch.depth, h});
  return mesh;
}

namespace {

template <class T>
void transform_in(Mesh& mesh, const Imath::Matrix44<T>& m) {
  const Imath::M44d wide(m);
  const double determinant = wide.determinant();
  if (!(std::abs(determinant) > 0) || !std::isfinite(determinant)) {
    throw Error(ErrorCode::bad_input, "the transform flattens the shape (a scale of 0)");
  }
  for (Vec3& p : mesh.positions) p = Vec3(Imath::Vec3<T>(p) * m);
  const Imath::Matrix44<T> normal_matrix(wide.inverse().transposed());
  for (Vec3& n : mesh.normals) {
    Imath::Vec3<T> turned;
    normal_matrix.multDirMatrix(Imath::Vec3<T>(n), turned);
    n = Vec3(turned.normalized());
  }
  for (Imath::V4f& t : mesh.tangents) {
    Imath::Vec3<T> turned;
    m.multDirMatrix(Imath::Vec3<T>(Vec3(t.x, t.y, t.z)), turned);
    const Vec3 along(turned.normalized());
    t = {along.x, along.y, along.z, determinant < 0 ? -t.w : t.w};
  }
  if (determinant < 0) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
}

}  // namespace

void transform(Mesh& mesh, const Mat4& m) {
  transform_in(mesh, m);
}
void transform(Mesh& mesh, const Imath::M44d& m) {
  transform_in(mesh, m);
}

void flip(Mesh& mesh) {
  for (Vec3& n : mesh.normals) n = -n;
  for (Imath::V4f& t : mesh.tangents) t.w = -t.w;
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

void append(Mesh& mesh, const Mesh& part) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
  mesh.uvs.insert(mesh.uvs.end(), part.uvs.begin(), part.uvs.end());
  mesh.tangents.insert(mesh.tangents.end(), part.tangents.begin(), part.tangents.end());
  mesh.triangles.reserve(mesh.triangles.size() + part.triangles.size());
  for (const auto& t : part.triangles)
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

std::vector<Vec3> smooth_normals(const Mesh& mesh) {
  std::vector<Imath::V3d> sums(mesh.positions.size(), Imath::V3d(0));
  for (const auto& [a, b, c] : mesh.triangles) {
    const Imath::V3d o(mesh.positions[a]);
    const Imath::V3d n =
        (Imath::V3d(mesh.positions[b]) - o).cross(Imath::V3d(mesh.positions[c]) - o);
    for (const std::uint32_t i : {a, b, c}) sums[i] += n;
  }
  std::vector<Vec3> normals;
  normals.reserve(sums.size());
  for (const Imath::V3d& sum : sums) {
    normals.push_back(sum.length2() > 0 ? Vec3(sum.normalized()) : Vec3(0, 1, 0));
  }
  return normals;
}

}  // namespace psf::render
