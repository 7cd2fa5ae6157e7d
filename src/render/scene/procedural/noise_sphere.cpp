// A ball carved by noise, as dense as one likes.
#include <cmath>

#include "render/scene/procedural/noise.h"
#include "render/scene/procedural/procedural.h"

namespace psf::render {
namespace {

class Carved {
 public:
  explicit Carved(const NoiseSphere& sphere) : sphere_(sphere), noise_(sphere.seed) {}

  // The point of the surface above the unit vector `d`.
  [[nodiscard]] Imath::V3d point(const Imath::V3d& d) const {
    const Imath::V3d q = d * sphere_.frequency;
    const Imath::V3d bent = q + noise_.vector(q * 0.7) * 0.6;
    double sum = 0, size = 1;
    for (std::uint32_t k = 0; k < sphere_.octaves; ++k) {
      const Imath::V3d at = bent / size + Imath::V3d(17.3 * k);
      const double value = noise_(at);
      // Folds with round backs and sharp valleys, but for the finest grain.
      sum += size * (k < 3 ? 1 - 2 * std::abs(value) : value);
      size /= 2;
    }
    return d * (sphere_.radius * (1 + sphere_.amplitude * (sum * 0.5)));
  }

  [[nodiscard]] Imath::V3d normal(const Imath::V3d& d) const {
    const double step = 1.0 / sphere_.segments;
    const Imath::V3d side = std::abs(d.y) < 0.6 ? Imath::V3d(0, 1, 0) : Imath::V3d(1, 0, 0);
    const Imath::V3d s = side.cross(d).normalized() * step, t = d.cross(s);
    const Imath::V3d u = point((d + s).normalized()) - point((d - s).normalized());
    const Imath::V3d v = point((d + t).normalized()) - point((d - t).normalized());
    return u.cross(v).normalized();
  }

 private:
  const NoiseSphere& sphere_;
  Noise noise_;
};

// The number of a grid's point, of n + 1 a row.
class Grid {
 public:
  Grid(std::size_t first, std::uint32_t n) : first_(static_cast<std::uint32_t>(first)), n_(n) {}
  [[nodiscard]] std::uint32_t operator()(std::uint32_t i, std::uint32_t j) const {
    return first_ + j * (n_ + 1) + i;
  }

 private:
  std::uint32_t first_, n_;
};

void add_triangles(Mesh& mesh, const Grid& at, std::uint32_t n) {
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
}

// The normals of points within a face, by the points around them.
void set_inner_normals(Mesh& mesh, const Grid& at, std::uint32_t n) {
  const auto across = [&](std::uint32_t from, std::uint32_t to) {
    return Imath::V3d(mesh.positions[to]) - Imath::V3d(mesh.positions[from]);
  };
  for (std::uint32_t j = 1; j < n; ++j) {
    for (std::uint32_t i = 1; i < n; ++i) {
      const Imath::V3d u = across(at(i - 1, j), at(i + 1, j)),
                       v = across(at(i, j - 1), at(i, j + 1));
      mesh.normals[at(i, j)] = Vec3(u.cross(v).normalized());
    }
  }
}

}  // namespace

Mesh make_noise_sphere(const NoiseSphere& sphere) {
  const Carved carved(sphere);
  const std::uint32_t n = sphere.segments;
  Mesh mesh;
  for (int face = 0; face < 6; ++face) {
    const int axis = face % 3;
    const double sign = face < 3 ? 1 : -1;
    const Grid at(mesh.positions.size(), n);
    for (std::uint32_t j = 0; j <= n; ++j) {
      for (std::uint32_t i = 0; i <= n; ++i) {
        // Points and normals of an edge are the same to the last bit from both of its faces.
        Imath::V3d d;
        d[axis] = sign;
        d[(axis + 1) % 3] = (2.0 * i - n) / n * sign;
        d[(axis + 2) % 3] = (2.0 * j - n) / n;
        d /= std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
        const bool on_edge = i == 0 || j == 0 || i == n || j == n;
        mesh.positions.push_back(Vec3(carved.point(d)));
        mesh.normals.push_back(on_edge ? Vec3(carved.normal(d)) : Vec3(0, 0, 0));
        mesh.uvs.emplace_back(static_cast<float>(i) / static_cast<float>(n),
                              static_cast<float>(j) / static_cast<float>(n));
      }
    }
    add_triangles(mesh, at, n);
    set_inner_normals(mesh, at, n);
  }
  return mesh;
}

}  // namespace psf::render
