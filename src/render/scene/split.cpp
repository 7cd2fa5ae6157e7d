// Triangles that are huge beside their distance from a camera, cut into smaller ones toward it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "render/scene/load_parts.h"

namespace psf::render {
namespace {

using Imath::V3d;

// Where a ray meets a triangle is known to some 2^-19 of the triangle's size (kOffsetScale): for
// one that is longer than so many times its distance from the camera, to 1% of that distance.
constexpr double kTooLong = 4096;
constexpr int kMostCuts = 64;  // deepest nesting of cuts of a triangle
// Floats give a sphere's surface to about 2^-18 of its radius. For a radius of kTooRound times the
// distance of a camera, that is 3% of the distance.
constexpr double kTooRound = 0x1p13;

double distance_to_segment(const V3d& p, const V3d& a, const V3d& b) {
  const V3d along = b - a;
  const double t = std::clamp((p - a).dot(along) / along.length2(), 0.0, 1.0);
  return (a + along * t - p).length();
}

double distance_to_triangle(const V3d& p, const V3d& a, const V3d& b, const V3d& c) {
  const V3d n = (b - a).cross(c - a).normalized();
  const auto inside = [&](const V3d& from, const V3d& to) {
    return n.dot((to - from).cross(p - from)) >= 0;
  };
  if (inside(a, b) && inside(b, c) && inside(c, a)) return std::abs(n.dot(p - a));
  return std::min(
      {distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

// A camera, and how near to it the mesh is: no edge need be shorter.
struct Eye {
  V3d place;
  double nearest;
};

class Splitter {
 public:
  Splitter(Mesh& mesh, std::vector<Eye> eyes) : mesh_(mesh), eyes_(std::move(eyes)) {}

  void run() {
    std::vector<std::array<std::uint32_t, 3>> whole;
    whole.swap(mesh_.triangles);
    for (const auto& triangle : whole) cut(triangle, 0);
  }

 private:
  // Whether an edge is to be cut. It depends on the edge's ends alone, so that both triangles at
  // the edge decide alike and no gap opens.
  [[nodiscard]] bool is_long(std::uint32_t i, std::uint32_t j) const {
    const V3d a(mesh_.positions[i]), b(mesh_.positions[j]);
    const double length = (b - a).length();
    return std::any_of(eyes_.begin(), eyes_.end(), [&](const Eye& eye) {
      return length > eye.nearest && length > distance_to_segment(eye.place, a, b);
    });
  }

  std::uint32_t middle(std::uint32_t i, std::uint32_t j) {
    const auto [entry, is_new] =
        middles_.try_emplace(std::minmax(i, j), static_cast<std::uint32_t>(mesh_.positions.size()));
    if (!is_new) return entry->second;
    add_middle(mesh_.positions, mesh_.normals, i, j);
    for (MeshStep& step : mesh_.motion) add_middle(step.positions, step.normals, i, j);
    if (!mesh_.rest.empty()) mesh_.rest.push_back(mesh_.rest[i] * 0.5f + mesh_.rest[j] * 0.5f);
    if (!mesh_.tangents.empty()) {
      const Imath::V4f &a = mesh_.tangents[i], &b = mesh_.tangents[j];
      mesh_.tangents.emplace_back(a.x + b.x, a.y + b.y, a.z + b.z, a.w);
    }
    if (!mesh_.uvs.empty()) mesh_.uvs.push_back((mesh_.uvs[i] + mesh_.uvs[j]) * 0.5f);
    return entry->second;
  }

  static void add_middle(std::vector<Vec3>& positions, std::vector<Vec3>& normals, std::uint32_t i,
                         std::uint32_t j) {
    positions.push_back(positions[i] * 0.5f + positions[j] * 0.5f);
    if (normals.empty()) return;
    const Vec3 sum = normals[i] + normals[j];
    normals.push_back(length_sq(sum) > 1e-12f ? sum.normalized() : normals[i]);
  }

  void cut(std::array<std::uint32_t, 3> t, int cuts) {
    const auto count = [&] {
      return is_long(t[0], t[1]) + is_long(t[1], t[2]) + is_long(t[2], t[0]);
    };
    const int edges = cuts < kMostCuts ? count() : 0;
    if (edges == 0) {
      mesh_.triangles.push_back(t);
      return;
    }
    // Turned so that with one long edge it is the first, with two it is not the last.
    while (edges < 3 && !(is_long(t[0], t[1]) && !is_long(t[2], t[0]))) {
      std::rotate(t.begin(), t.begin() + 1, t.end());
    }
    const std::uint32_t ab = middle(t[0], t[1]);
    if (edges == 1) {
      cut({t[0], ab, t[2]}, cuts + 1);
      cut({ab, t[1], t[2]}, cuts + 1);
      return;
    }
    const std::uint32_t bc = middle(t[1], t[2]);
    cut({ab, t[1], bc}, cuts + 1);
    if (edges == 2) {
      cut({t[0], ab, bc}, cuts + 1);
      cut({t[0], bc, t[2]}, cuts + 1);
      return;
    }
    const std::uint32_t ca = middle(t[2], t[0]);
    cut({t[0], ab, ca}, cuts + 1);
    cut({ca, bc, t[2]}, cuts + 1);
    cut({ab, bc, ca}, cuts + 1);
  }

  Mesh& mesh_;
  std::vector<Eye> eyes_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles_;
};

// The cameras that a triangle of the mesh is too long for.
std::vector<Eye> near_eyes(const Mesh& mesh, const std::vector<Camera>& cameras) {
  std::vector<Eye> eyes;
  for (const Camera& camera : cameras) {
    const V3d place(camera.eye);
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& [i, j, k] : mesh.triangles) {
      const V3d a(mesh.positions[i]), b(mesh.positions[j]), c(mesh.positions[k]);
      const double longest_sq = std::max({(b - a).length2(), (c - b).length2(), (a - c).length2()});
      // Most triangles are small and far: that is seen without more ado.
      const double reach = std::sqrt(longest_sq), gap = (a - place).length() - reach;
      if (gap * kTooLong >= reach) continue;
      const double distance = distance_to_triangle(place, a, b, c);
      if (distance * kTooLong < reach) {
        // A camera in the triangle itself: what floats tell apart there.
        nearest = std::min(nearest, std::max(distance, reach * 0x1p-56));
      }
    }
    if (std::isfinite(nearest)) eyes.push_back({place, nearest});
  }
  return eyes;
}

}  // namespace

void split_large_triangles(Scene& scene) {
  for (Mesh& mesh : scene.meshes) {
    std::vector<Eye> eyes = near_eyes(mesh, scene.cameras);
    if (!eyes.empty()) Splitter(mesh, std::move(eyes)).run();
  }
}

void check_large_spheres(const std::string& path, const Scene& scene) {
  for (const Sphere& sphere : scene.spheres) {
    for (const Camera& camera : scene.cameras) {
      const double from_center = (V3d(camera.eye) - V3d(sphere.center)).length();
      const double times = double{sphere.radius} / std::abs(from_center - double{sphere.radius});
      if (!(times > kTooRound)) continue;
      throw Error(
          ErrorCode::limit,
          fmt::format("{}: sphere {}: its radius of {:.3g} is {:.3g} times the distance of a "
                      "camera from it, {:.0f} times are the most; make it smaller, or a mesh",
                      path, sphere.name, std::ldexp(double{sphere.radius}, scene.space.exponent),
                      times, kTooRound));
    }
  }
}

}  // namespace psf::render
