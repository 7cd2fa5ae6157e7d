// The space that a scene is loaded in: where floats have digits for it.
#include <ImathBox.h>
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "render/scene/copies.h"
#include "render/scene/load_parts.h"

namespace psf::render {
namespace {

// A scene as far from the origin as this many times its size is moved: farther, its coordinates
// lose more than 6 of their 24 bits.
constexpr double kFar = 64;
// The sizes of scenes, as exponents of two, at which products of lengths fit in floats with room on
// both sides. Most of the room is below, for small parts of a large scene.
constexpr int kSmall = -10, kLarge = 20, kMiddle = 10;
// The range of world units in which a dump's floats can hold distances between parts of a scene,
// and sums of these.
constexpr double kLargestWorld = 1e36, kSmallestWorld = 1e-30;
// Doubles, as in the files, have 53 bits: so many times its size from the origin, a scene keeps 13.
constexpr double kFarthest = 0x1p40;

// A shape, or the positions of a dump, of fewer steps of a float have lost their form.
constexpr double kStepsOfShape = 64, kStepsOfDump = 4096;

// That a warning is about.
struct OddShapes {
  const char* what;
  std::size_t count = 0;
  std::string first = {};
};

// Between floats of this size.
double float_step(double size) {
  return size > 0 ? std::ldexp(1.0, std::ilogb(size) - 23) : 0;
}

double largest(const Imath::V3d& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// The bounds of all triangles, instances, spheres and curves. Values that are not finite, and
// indices of no vertex, are reported later.
Imath::Box3d bounds_of(const Scene& scene) {
  Imath::Box3d box;
  for (const Mesh& mesh : scene.meshes) {
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t i : triangle) {
        if (i < mesh.positions.size() && is_finite(mesh.positions[i])) {
          box.extendBy(Imath::V3d(mesh.positions[i]));
        }
      }
    }
  }
  std::vector<Imath::Box3d> prototypes;
  for (const Mesh& mesh : scene.prototypes) prototypes.push_back(bounds_of(mesh));
  for (const Instance& instance : scene.instances) {
    const Imath::Box3d placed = bounds_of(prototypes[instance.prototype], instance);
    if (is_finite(Vec3(placed.min)) && is_finite(Vec3(placed.max))) box.extendBy(placed);
  }
  for (const Sphere& sphere : scene.spheres) {
    if (!is_finite(sphere.center) || !std::isfinite(sphere.radius)) continue;
    const Imath::V3d center(sphere.center), reach(double{sphere.radius});
    box.extendBy(center - reach);
    box.extendBy(center + reach);
  }
  for (const Curves& curves : scene.curves) {
    for (const CurvePoint& p : curves.points) {
      if (!is_finite(p.position) || !std::isfinite(p.radius)) continue;
      box.extendBy(Imath::V3d(p.position) - Imath::V3d(double{p.radius}));
      box.extendBy(Imath::V3d(p.position) + Imath::V3d(double{p.radius}));
    }
  }
  return box;
}

void check_limits(const std::string& path, const Space& space, const Imath::V3d& center,
                  double half) {
  const double unit = std::ldexp(1.0, space.exponent);
  const double reach = largest(space.origin + center * unit) + half * unit;
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorCode::limit, fmt::format("{}: {}", path, what));
  };
  if (reach > kLargestWorld) {
    fail(
        fmt::format("the scene reaches {:.3g} units from the origin, {:.0e} are the most; scale it",
                    reach, kLargestWorld));
  }
  if (half > 0 && half * unit < kSmallestWorld) {
    fail(fmt::format("the scene is {:.3g} units across, {:.0e} are the least; scale it",
                     2 * half * unit, kSmallestWorld));
  }
  if (half > 0 && largest(space.origin) > kFarthest * half * unit) {
    fail(fmt::format(
        "the scene is {:.3g} units across and {:.3g} from the origin, where the numbers "
        "of a file have no digits for it; move it nearer than {:.0e} times its size",
        2 * half * unit, largest(space.origin), kFarthest));
  }
}

}  // namespace

Space moved_space(Space space, const Imath::Box3d& box) {
  if (box.isEmpty()) return space;
  const Imath::V3d center = box.center();
  const double half = largest(box.size()) / 2;
  if (largest(center) <= kFar * half) return space;
  // A short number, so that taking it off others leaves numbers that are as short as they were.
  const double step = half > 0 ? std::ldexp(1.0, std::ilogb(half)) : float_step(largest(center));
  for (int axis = 0; axis < 3; ++axis) {
    space.origin[axis] += std::ldexp(std::round(center[axis] / step) * step, space.exponent);
  }
  space.exact = true;
  return space;
}

Space fitting_space(const Scene& scene) {
  if (scene.wanted.exact) return scene.wanted;
  const Imath::Box3d box = bounds_of(scene);
  Space space = moved_space(scene.space, box);
  if (box.isEmpty() || !(space == scene.space)) return space;
  const double half = largest(box.size()) / 2;
  const int size = half > 0 ? std::ilogb(half) : kMiddle;
  if (size < kSmall || size > kLarge) {
    space.exponent += size - (size > kLarge ? kLarge : kMiddle);
    space.exact = true;
    return space;
  }
  return space;
}

void check_scale(const std::string& path, const Scene& scene) {
  const Imath::Box3d box = bounds_of(scene);
  if (!box.isEmpty()) check_limits(path, scene.space, box.center(), largest(box.size()) / 2);
}

double WorldDigits::steps() const {
  return step > 0 ? across / step : std::numeric_limits<double>::infinity();
}

WorldDigits world_digits(const Scene& scene) {
  const Imath::Box3d box = bounds_of(scene);
  if (box.isEmpty()) return {};
  const double unit = std::ldexp(1.0, scene.space.exponent);
  const double reach =
      largest(scene.space.origin + box.center() * unit) + largest(box.size()) / 2 * unit;
  return {largest(box.size()) * unit, reach, float_step(reach)};
}

void note_lost_digits(const std::string& path, Scene& scene) {
  const WorldDigits world = world_digits(scene);
  if (world.steps() < kStepsOfDump) {
    scene.warnings.push_back(fmt::format(
        "{}: vertices {:.3g} from the origin: the positions of a dump keep {:.3g} of a unit there, "
        "the scene is {:.3g} across; pictures lose nothing",
        path, world.reach, world.step, world.across));
  }
  OddShapes small{"smaller than 64 steps of a float where it is, so that its form is lost"};
  OddShapes tiny{"so small beside the scene that it may not be seen"};
  const auto check = [&](const char* kind, const std::string& name, double across, double reach) {
    for (OddShapes* which : {across < kStepsOfShape * float_step(reach) ? &small : nullptr,
                             across < double{kLeastLength} ? &tiny : nullptr}) {
      if (which == nullptr || which->count++ > 0) continue;
      which->first = fmt::format("{} {}, {:.3g} across, {:.3g} from the middle", kind, name,
                                 std::ldexp(across, scene.space.exponent),
                                 std::ldexp(reach, scene.space.exponent));
    }
  };
  for (const Mesh& mesh : scene.meshes) {
    Imath::Box3d box;
    for (const Vec3& p : mesh.positions) box.extendBy(Imath::V3d(p));
    check("mesh", mesh.name, largest(box.size()), largest(box.center()));
  }
  std::vector<Imath::Box3d> prototypes;
  for (const Mesh& mesh : scene.prototypes) prototypes.push_back(bounds_of(mesh));
  for (const Instance& instance : scene.instances) {
    const Imath::Box3d box = bounds_of(prototypes[instance.prototype], instance);
    check("mesh", scene.prototypes[instance.prototype].name, largest(box.size()),
          largest(box.center()));
  }
  for (const Sphere& sphere : scene.spheres) {
    check("sphere", sphere.name, 2 * double{sphere.radius}, largest(Imath::V3d(sphere.center)));
  }
  for (const OddShapes* which : {&small, &tiny}) {
    if (which->count == 0) continue;
    const std::string others =
        which->count == 1 ? "" : fmt::format(", and {} more", which->count - 1);
    scene.warnings.push_back(fmt::format("{}: {}: {}{}", path, which->what, which->first, others));
  }
}

Scene load_fitting(const std::string& path, const std::function<void(Scene&)>& load) {
  // Floats tell roughly where a scene is, doubles around that place how large it is.
  constexpr int kMostTries = 6;
  Space space;
  for (int tries = 1;; ++tries) {
    Scene scene;
    scene.space = space;
    try {
      load(scene);
    } catch (const Error& error) {
      // Far from the origin what is wrong may be the rounding to float.
      if (space.exact || error.code() == ErrorCode::interrupted) throw;
      space.exact = true;
      continue;
    }
    space = fitting_space(scene);
    if (space == scene.space) return scene;
    stop_where_interrupted();
    if (tries == kMostTries) {
      throw Error(ErrorCode::limit, path +
                                        ": no place and size to compute in is found for the "
                                        "scene; move it to the origin, or scale it");
    }
  }
}

}  // namespace psf::render
