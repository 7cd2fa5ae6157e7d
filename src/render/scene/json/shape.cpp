// Shapes of the JSON scene file, expanded into the meshes and spheres of the scene.
#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "core/error.h"
#include "render/scene/copies.h"
#include "render/scene/json/parts.h"
#include "render/scene/shapes.h"

namespace psf::render {
namespace {

constexpr int kMaxGroupDepth = 32;  // deepest nesting of groups
constexpr std::uint32_t kMaxSegments = 65536;

// What is taken off the coordinates of a shape, and added by its placement: its first point, so
// that the shape has all digits of its numbers even far from the origin.
class Base {
 public:
  // `point`: of the shape; null for none.
  Base(const JsonLoad& load, const std::optional<JsonCursor>& point) {
    if (load.scene.space.exact && point) base_ = point->vec3d();
  }
  [[nodiscard]] Vec3 point(const JsonCursor& json) const { return Vec3(json.vec3d() - base_); }
  [[nodiscard]] const Imath::V3d& place() const { return base_; }

 private:
  Imath::V3d base_{0, 0, 0};
};

Mesh read_inline_mesh(const JsonCursor& json, const Base& base) {
  Mesh mesh;
  for (const JsonCursor& p : json.items("positions")) mesh.positions.push_back(base.point(p));
  for (const JsonCursor& n : json.items("normals")) mesh.normals.push_back(n.vec3());
  for (const JsonCursor& uv : json.items("uvs")) mesh.uvs.push_back(uv.vec2());
  if (mesh.positions.empty()) json.fail("\"positions\" is missing or empty");
  const auto match = [&](std::string_view key, std::size_t count) {
    if (count != 0 && count != mesh.positions.size()) {
      json.at(key).fail(fmt::format("there are {} for {} positions", count, mesh.positions.size()));
    }
  };
  match("normals", mesh.normals.size());
  match("uvs", mesh.uvs.size());
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (const JsonCursor& triangle : json.at("triangles").items()) {
    const auto corners = triangle.items();
    if (corners.size() != 3) triangle.expected("an array of 3 indices");
    mesh.triangles.push_back(
        {corners[0].integer(0, last), corners[1].integer(0, last), corners[2].integer(0, last)});
  }
  return mesh;
}

std::uint32_t read_segments(const JsonCursor& json, std::uint32_t otherwise) {
  const auto segments = json.find("segments");
  return segments ? segments->integer(3, kMaxSegments) : otherwise;
}

Mesh read_lathe(const JsonCursor& json) {
  std::vector<Vec2> profile;
  const JsonCursor points = json.at("profile");
  for (const JsonCursor& point : points.items()) {
    profile.push_back(point.vec2());
    if (profile.back().x < 0) point.expected("a radius >= 0 and a height");
  }
  if (profile.size() < 2) points.expected("at least two points");
  return make_lathe(profile, read_segments(json, 32));
}

Mesh read_cylinder(const JsonCursor& json, const Base& base) {
  const Vec3 from = base.point(json.at("from")), to = base.point(json.at("to"));
  const float radius = json.at("radius").number(kPositive);
  const auto to_radius = json.find("to_radius");
  const auto caps = json.find("caps");
  if (!((to - from).length() > 0)) json.fail("\"from\" and \"to\" are the same point");
  return make_cylinder(from, to, radius, to_radius ? to_radius->number(kNonNegative) : radius,
                       read_segments(json, 32), caps ? caps->boolean() : true);
}

Mesh read_box(const JsonCursor& json, const Base& base) {
  const Vec3 min = base.point(json.at("min")), max = base.point(json.at("max"));
  if (!(min.x < max.x && min.y < max.y && min.z < max.z)) {
    json.fail("\"min\" is not below \"max\" in each of x, y and z");
  }
  return make_box(min, max);
}

Mesh read_arch(const JsonCursor& json) {
  Arch arch;
  arch.width = json.at("width").number(kPositive);
  arch.height = json.at("height").number(kPositive);
  arch.depth = json.at("depth").number(kPositive);
  const JsonCursor span = json.at("span");
  arch.span = span.number(kPositive);
  if (arch.span > arch.width) span.fail("the opening is wider than the panel");
  const auto rise = json.find("rise");
  arch.rise = rise ? rise->number(kPositive) : arch.span / 2;
  if (!(arch.rise < arch.height))
    (rise ? *rise : span).fail("the opening is higher than the panel");
  arch.segments = read_segments(json, arch.segments);
  return make_arch(arch);
}

// In float or double, see Placement.
template <class T>
void add_sphere(const JsonCursor& json, const Sphere& sphere, const Imath::Vec3<T>& center,
                const std::vector<Placement>& placements, JsonLoad& load) {
  load.copies.add(json, 1, 0, placements.size());
  for (const Placement& placement : placements) {
    const Imath::Matrix44<T> m(placement);
    const std::optional<T> scale = even_scale(m);
    if (!scale)
      json.fail(
          "a sphere can be moved, turned and scaled evenly only; use a lathe for an ellipsoid");
    Sphere copy = sphere;
    copy.center = Vec3(center * m);
    copy.radius = static_cast<float>(static_cast<T>(sphere.radius) * *scale);
    load.scene.spheres.push_back(std::move(copy));
  }
}

constexpr std::string_view kShapes[] = {"group", "sphere",       "quad",     "box",    "arch",
                                        "lathe", "mesh",         "cylinder", "curves", "hairball",
                                        "tree",  "noise-sphere", "tuft"};
enum ShapeKind : std::size_t {
  group,
  sphere,
  quad,
  box,
  arch,
  lathe,
  mesh_shape,
  cylinder,
  curves,
  hairball,
  tree,
  noise_sphere,
  tuft
};

void check_shape_keys(const JsonCursor& json, std::size_t kind, bool from_file) {
  static const std::vector<std::string_view> kKeys[] = {
      {"shapes"},
      {"center", "radius"},
      {"origin", "u", "v"},
      {"min", "max"},
      {"width", "height", "depth", "span", "rise", "segments"},
      {"profile", "segments"},
      {"file", "positions", "triangles", "normals", "uvs"},
      {"from", "to", "radius", "to_radius", "segments", "caps"},
      {"strands", "segments"},
      {"seed", "radius", "thickness", "curl", "strands", "segments"},
      {"seed", "height", "leaves", "leaf_size", "leaf_material"},
      {"seed", "radius", "amplitude", "frequency", "octaves", "segments"},
      {"seed", "height", "spread", "width", "bend", "blades"}};
  std::vector<std::string_view> known = {"shape",     "name",   "transform",
                                         "keyframes", "repeat", "scatter"};
  if (kind != group) known.push_back("material");
  const bool one_mesh =
      kind != group && kind != sphere && kind != curves && kind != hairball && kind != tree;
  if (one_mesh) known.insert(known.end(), {"flip", "uv_scale"});
  known.insert(known.end(), kKeys[kind].begin(), kKeys[kind].end());
  if (from_file) {
    known = {"shape",   "name",     "transform", "keyframes", "repeat",
             "scatter", "material", "flip",      "file"};
  }
  json.check_keys(known);
}

// A point of a shape that has points.
std::optional<JsonCursor> point_of(const JsonCursor& json, std::size_t kind) {
  switch (kind) {
    case quad:
      return json.find("origin");
    case box:
      return json.find("min");
    case cylinder:
      return json.find("from");
    case mesh_shape: {
      const auto points = json.find("positions");
      return points && points->size() > 0 ? std::optional(points->item(0)) : std::nullopt;
    }
    default:
      return std::nullopt;
  }
}

Mesh read_mesh(const JsonCursor& json, std::size_t kind, const Base& base) {
  switch (kind) {
    case quad:
      return make_quad(base.point(json.at("origin")), json.at("u").vec3(), json.at("v").vec3());
    case box:
      return read_box(json, base);
    case arch:
      return read_arch(json);
    case lathe:
      return read_lathe(json);
    case cylinder:
      return read_cylinder(json, base);
    case noise_sphere:
      return read_noise_sphere(json);
    case tuft:
      return read_tuft(json);
    default:
      return read_inline_mesh(json, base);
  }
}

}  // namespace

void add_mesh(const JsonCursor& json, const Mesh& mesh, const std::vector<Placement>& placements,
              JsonLoad& load) {
  const bool instanced = !load.moves && is_instanced(load.scene, mesh, placements);
  load.copies.add(json, mesh.triangles.size(), mesh.positions.size(), placements.size(), instanced);
  try {
    add_copies(load.scene, mesh, placements, load.scene.space.exact, instanced);
  } catch (const Error& error) {
    json.fail(error.what());
  }
}

namespace {

// Adds the copies of a shape, whose keys were checked, at each of `placements`.
void add_shape(const JsonCursor& json, std::size_t kind, bool from_file,
               std::vector<Placement> placements, JsonLoad& load, int depth) {
  const bool exact = load.scene.space.exact;
  if (kind == group) {
    if (depth == kMaxGroupDepth)
      json.fail(fmt::format("more than {} groups within groups", kMaxGroupDepth));
    for (const JsonCursor& part : json.at("shapes").items())
      read_shape(part, placements, load, depth + 1);
    return;
  }

  const int material = read_material_name(json, load.scene, !from_file);
  const auto name_json = json.find("name"), flip_json = json.find("flip");
  const std::string name = name_json ? name_json->text() : json.path();
  const bool flipped = flip_json && flip_json->boolean();
  if (from_file) return add_mesh_file(json, material, flipped, placements, load);
  if (kind == sphere) {
    const Imath::V3d center = json.at("center").vec3d();
    const Sphere ball{name, Vec3(center), json.at("radius").number(kPositive), material};
    return exact ? add_sphere(json, ball, center, placements, load)
                 : add_sphere(json, ball, ball.center, placements, load);
  }
  if (kind == curves || kind == hairball)
    return add_curves(json, kind == hairball, name, material, placements, load);
  if (kind == tree) return add_tree(json, name, material, placements, load);
  const Base base(load, point_of(json, kind));
  Mesh mesh = read_mesh(json, kind, base);
  if (exact) {
    const Placement back = Placement().setTranslation(base.place());
    for (Placement& placement : placements) placement = back * placement;
  }
  if (const auto scale = json.find("uv_scale")) {
    const Vec2 factors = scale->vec2();
    for (Vec2& uv : mesh.uvs) uv *= factors;
  }
  if (flipped) flip(mesh);
  mesh.name = name;
  mesh.material = material;
  add_mesh(json, mesh, placements, load);
}

}  // namespace

void read_shape(const JsonCursor& json, const std::vector<Placement>& around, JsonLoad& load,
                int depth) {
  const std::size_t kind = json.at("shape").choice(kShapes);
  const bool from_file = kind == mesh_shape && json.find("file").has_value();
  check_shape_keys(json, kind, from_file);
  const bool exact = load.scene.space.exact;
  const bool around_moves = load.moves;
  load.moves = around_moves || json.find("keyframes").has_value();
  add_shape(json, kind, from_file, combine(json, read_placements(json, load.scene), around, exact),
            load, depth);
  load.moves = around_moves;
}

}  // namespace psf::render
