// What every loaded scene is checked for, whatever file it came from.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "render/scene/copies.h"
#include "render/scene/density_grid.h"
#include "render/scene/load_parts.h"
#include "render/scene/shapes.h"

namespace psf::render {
namespace {

// A triangle lower than this fraction of its longest side has no area to the precision of its
// coordinates.
constexpr double kFlat = 1e-7;

// In the scene's space: Embree divides by the squares of segments of curves, and takes those of
// less than 1e-18 for something else.
constexpr double kShortest = 0x1p-23;

bool is_flat(const Imath::V3d& a, const Imath::V3d& b, const Imath::V3d& c) {
  const Imath::V3d u = b - a, v = c - a, w = c - b;
  const double longest_sq = std::max({u.length2(), v.length2(), w.length2()});
  const Imath::V3d n = u.cross(v);
  return !(n.length2() > kFlat * kFlat * longest_sq * longest_sq);
}

class Validation {
 public:
  Validation(const std::string& path, Scene& scene) : path_(path), scene_(scene) {}

  void run() {
    if (is_empty()) fail("the scene has no shapes, there is nothing to render");
    for (const Medium& medium : scene_.media) check(medium);
    for (Material& material : scene_.materials) check(material);
    for (Mesh& mesh : scene_.meshes) check(mesh);
    for (Mesh& mesh : scene_.prototypes) check(mesh);
    if (dropped_ > 0) {
      warn(fmt::format(
          "{} of {} triangles have no area and are left out (the first is triangle {} of mesh {})",
          dropped_, triangles_, first_dropped_, first_dropped_mesh_));
    }
    if (bad_normals_ > 0) {
      warn(fmt::format("{} normals of length 0 are replaced by those of the triangles around",
                       bad_normals_));
    }
    std::erase_if(scene_.meshes, [](const Mesh& mesh) { return mesh.triangles.empty(); });
    std::erase_if(scene_.instances, [this](const Instance& instance) {
      return scene_.prototypes[instance.prototype].triangles.empty();
    });
    if (is_empty()) fail("no triangle of the scene has an area");
    check_instances();
    for (const Sphere& sphere : scene_.spheres) check(sphere);
    for (const Curves& curves : scene_.curves) check(curves);
    for (const Light& light : scene_.lights) check(light);
  }

 private:
  [[nodiscard]] bool is_empty() const {
    return scene_.meshes.empty() && scene_.spheres.empty() && scene_.instances.empty() &&
           scene_.curves.empty();
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::bad_input, path_ + ": " + what);
  }
  void warn(const std::string& what) { scene_.warnings.push_back(path_ + ": " + what); }

  void check(const Medium& medium) const {
    const float density = medium.density != nullptr ? std::max(1.0f, medium.density->most()) : 1;
    const Rgb coefficients = medium.sigma_t() * density;
    const bool fits = coefficients.x >= 0 && coefficients.y >= 0 && coefficients.z >= 0 &&
                      std::isfinite(max_component(coefficients));
    if (!fits) {
      fail(fmt::format(
          "medium {}: a coefficient is not a finite number >= 0 at the size of the scene",
          medium.name));
    }
  }

  void check(Material& material) const {
    const auto say = [&](const std::string& what) {
      fail(fmt::format("material {}: {}", material.name, what));
    };
    const auto unit = [&](float& value, const char* what) {
      // What a converter rounded is no error.
      if (value > 1 && value < 1.0001f) value = 1;
      if (!(value >= 0 && value <= 1))
        say(fmt::format("{} is {}, expected a number in [0, 1]", what, value));
    };
    for (int c = 0; c < 3; ++c) {
      unit(material.reflectance[c], "the reflectance");
      unit(material.specular[c], "the specular reflectance");
      const float emission = material.emission[c];
      if (!(emission >= 0) || !std::isfinite(emission)) {
        say(fmt::format("the emission is {}, expected a finite number >= 0", emission));
      }
    }
    unit(material.roughness, "the roughness");
    unit(material.clearcoat, "the clear coat");
    unit(material.clearcoat_roughness, "the roughness of the clear coat");
    unit(material.metalness, "the metalness");
    unit(material.opacity, "the opacity");
    if (!(material.ior >= 1 && material.ior <= 10)) {
      say(fmt::format("the index of refraction is {}, expected a number in [1, 10]", material.ior));
    }
  }

  void check(Mesh& mesh) {
    const auto say = [&](const std::string& what) {
      fail(fmt::format("mesh {}: {}", mesh.name, what));
    };
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const Vec3& p = mesh.positions[i];
      if (!is_finite(p)) say(fmt::format("vertex {} is not finite", i));
      if (!in_space(p)) {
        const Imath::V3d w = scene_.space.world(p);
        say(fmt::format("vertex {} is farther away than {} times the scene's size ({}, {}, {})", i,
                        kFarthest, w.x, w.y, w.z));
      }
    }
    for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
      if (!std::isfinite(mesh.uvs[i].x) || !std::isfinite(mesh.uvs[i].y)) {
        say(fmt::format("the texture coordinates of vertex {} are not finite", i));
      }
    }
    triangles_ += mesh.triangles.size();
    if (triangles_ + scene_.spheres.size() > kMaxPrimitives) {
      throw Error(ErrorCode::limit,
                  fmt::format("{}: more than {} triangles", path_, kMaxPrimitives));
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (const std::uint32_t index : mesh.triangles[t]) {
        if (index >= mesh.positions.size()) {
          say(fmt::format("triangle {} names vertex {}, there are {}", t, index,
                          mesh.positions.size()));
        }
      }
    }
    drop_flat_triangles(mesh);
    mend_normals(mesh);
  }

  void check_instances() const {
    std::vector<Imath::Box3d> boxes;
    for (const Mesh& mesh : scene_.prototypes) boxes.push_back(bounds_of(mesh));
    for (const Instance& instance : scene_.instances) {
      const Imath::Box3d box = bounds_of(boxes[instance.prototype], instance);
      if (in_space(Vec3(box.min)) && in_space(Vec3(box.max))) continue;
      fail(fmt::format(
          "mesh {}: a copy is not finite, or farther away than {} times the scene's size",
          scene_.prototypes[instance.prototype].name, kFarthest));
    }
  }

  void drop_flat_triangles(Mesh& mesh) {
    std::size_t kept = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      const auto corner = [&](std::uint32_t i) { return Imath::V3d(mesh.positions[i]); };
      if (is_flat(corner(a), corner(b), corner(c))) {
        if (dropped_ == 0) {
          first_dropped_ = t;
          first_dropped_mesh_ = mesh.name;
        }
        ++dropped_;
      } else {
        mesh.triangles[kept++] = mesh.triangles[t];
      }
    }
    mesh.triangles.resize(kept);
  }

  // Makes normals unit; those without direction become the mean of the triangles around.
  void mend_normals(Mesh& mesh) {
    if (mesh.normals.empty()) return;
    std::vector<Vec3> around;
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
      Vec3& n = mesh.normals[i];
      if (!is_finite(n))
        fail(fmt::format("mesh {}: the normal of vertex {} is not finite", mesh.name, i));
      const float length = n.length();
      // Imath scales before it squares, so a tiny normal keeps its direction.
      if (length > 0 && std::isfinite(length)) {
        n /= length;
        continue;
      }
      if (around.empty()) around = smooth_normals(mesh);
      n = around[i];
      ++bad_normals_;
    }
  }

  void check(const Sphere& sphere) const {
    const Vec3& c = sphere.center;
    if (!is_finite(c) || !(sphere.radius > 0 && std::isfinite(sphere.radius))) {
      fail(fmt::format("sphere {}: its centre is not finite, or its radius not above 0",
                       sphere.name));
    }
    if (!in_space(c) || sphere.radius > kFarthest) {
      fail(fmt::format("sphere {}: is too large, or too far away for the size of the scene",
                       sphere.name));
    }
  }

  void check(const Curves& curves) const {
    const auto say = [&](const std::string& what) {
      fail(fmt::format("curves {}: {}", curves.name, what));
    };
    for (std::size_t i = 0; i < curves.points.size(); ++i) {
      const CurvePoint& p = curves.points[i];
      if (!in_space(p.position) || !(p.radius >= 0 && p.radius <= kFarthest)) {
        say(fmt::format("point {} is not finite, or too far away for the size of the scene", i));
      }
    }
    for (const std::uint32_t segment : curves.segments) {
      if (segment + std::size_t{1} >= curves.points.size())
        say(fmt::format("a segment begins at point {} of {}", segment, curves.points.size()));
      const CurvePoint &from = curves.points[segment], &to = curves.points[segment + 1];
      const double length = (Imath::V3d(to.position) - Imath::V3d(from.position)).length();
      // One ball within the other is no matter.
      if (length >= kShortest || length <= std::abs(double{to.radius} - double{from.radius}))
        continue;
      const auto world = [&](double local) { return std::ldexp(local, scene_.space.exponent); };
      say(
          fmt::format("the segment from point {} is {:.3g} long, {:.3g} is the least at the size "
                      "of the scene; leave points out, or ask for fewer `segments`",
                      segment, world(length), world(kShortest)));
    }
    const Material& material = scene_.materials[static_cast<std::size_t>(curves.material)];
    if (material.kind == MaterialKind::glass || !is_black(material.emission)) {
      say(fmt::format("curves are neither glass nor lights, as the material {} is", material.name));
    }
  }

  void check(const Light& light) const {
    const auto say = [&](const char* what) { fail(fmt::format("light {}: {}", light.name, what)); };
    for (int c = 0; c < 3; ++c) {
      if (!(light.intensity[c] >= 0) || !std::isfinite(light.intensity[c])) {
        say("the intensity is not a finite number >= 0");
      }
    }
    if (light.kind != LightKind::directional && !in_space(light.position)) {
      say("the position is not finite, or too far away for the size of the scene");
    }
    if (light.kind != LightKind::point && !(std::abs(light.direction.length() - 1) < 1e-3f)) {
      say("the direction is not a unit vector");
    }
  }

  const std::string& path_;
  Scene& scene_;
  std::size_t triangles_ = 0, dropped_ = 0, first_dropped_ = 0, bad_normals_ = 0;
  std::string first_dropped_mesh_;
};

}  // namespace

void validate(const std::string& path, Scene& scene) {
  Validation(path, scene).run();
}

}  // namespace psf::render
