// The command line's changes to a scene, the camera of a scene that has none, and the checks of
// cameras.
#include <ImathBox.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "render/scene/copies.h"
#include "render/scene/load_parts.h"

namespace psf::render {
namespace {

constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 30;

[[noreturn]] void misuse(const std::string& what) {
  throw Error(ErrorCode::usage, what);
}

Vec3 unit(const Vec3& v, const char* option) {
  const float length = v.length();
  if (!(length > 0) || !std::isfinite(length))
    misuse(fmt::format("{}: expected a direction, not 0 0 0", option));
  return v / length;
}

void check_radiance(const Rgb& c, const char* option) {
  for (int i = 0; i < 3; ++i) {
    if (!(c[i] >= 0) || !std::isfinite(c[i]))
      misuse(fmt::format("{}: expected finite numbers >= 0", option));
  }
}

void override_lights(const SceneOverrides& o, Scene& scene) {
  if (o.sky || o.sky_map) {
    scene.environment = Environment{};
    scene.environment.radiance = o.sky.value_or(Rgb(1));
    check_radiance(scene.environment.radiance, "`sky`");
  }
  if (o.sky_map) {
    scene.textures.push_back(Texture::load(*o.sky_map, TextureUse::radiance, scene.warnings));
    scene.environment.texture = static_cast<int>(scene.textures.size()) - 1;
  }
  if (o.sun || o.sun_direction) {
    if (!(o.sun_angle >= 0 && o.sun_angle < std::numbers::pi_v<float> / 2)) {
      misuse("the sun's angular radius: expected a number in [0, pi/2)");
    }
    Light sun;
    sun.name = "sun";
    sun.kind = LightKind::directional;
    sun.direction = -unit(o.sun_direction.value_or(Vec3(0.4f, 1.0f, 0.3f)), "`sun`");
    sun.intensity = o.sun.value_or(Rgb(3));
    sun.angle = o.sun_angle;
    check_radiance(sun.intensity, "`sun`");
    scene.lights.push_back(std::move(sun));
  }
}

// Cube crosses, strips and mirror balls do not say what they are; their shape tells.
void note_environment(Scene& scene) {
  if (scene.environment.texture == kNone) return;
  const Texture& map = scene.textures[static_cast<std::size_t>(scene.environment.texture)];
  const std::size_t width = map.width(), height = map.height();
  if (height < 8 || std::max(width, 2 * height) - std::min(width, 2 * height) <= height / 16)
    return;
  scene.warnings.push_back(fmt::format(
      "{}: the environment's picture of {} x {} texels is stretched: one of latitude and longitude "
      "is twice as wide as high",
      scene.name, width, height));
}

void check_camera(const Camera& camera, std::size_t index, const std::string& file) {
  const auto fail = [&](const std::string& what, ErrorCode code = ErrorCode::bad_input) {
    throw Error(code, fmt::format("{}: camera {}{}{}: {}", file, index,
                                  camera.name.empty() ? "" : " ", camera.name, what));
  };
  if (!is_finite(camera.eye) || !is_finite(camera.target) || !is_finite(camera.up)) {
    fail("eye, target and up must be finite");
  }
  if (!in_space(camera.eye) || !in_space(camera.target)) {
    fail(fmt::format("eye or target is farther away than {:.0e} times the scene's size", kFarthest),
         ErrorCode::limit);
  }
  const Vec3 view = camera.target - camera.eye;
  if (!(view.length() > 0)) fail("eye and target are the same point, so it looks nowhere");
  if (!(cross(view.normalized(), camera.up.normalized()).length() > 1e-5f)) {
    fail("looks along its up direction; choose another \"up\"");
  }
  if (!(camera.fov > 0 && camera.fov < std::numbers::pi_v<float>)) {
    fail(fmt::format("the field of view is {} degrees, expected one between 0 and 180",
                     camera.fov / kRadians));
  }
  if (camera.width == 0 || camera.height == 0) {
    fail(fmt::format("a picture of {} x {} pixels has none", camera.width, camera.height));
  }
  if (std::uint64_t{camera.width} * camera.height > kMaxPixels) {
    fail(fmt::format("a picture of {} x {} pixels is more than psf takes ({} pixels)", camera.width,
                     camera.height, kMaxPixels),
         ErrorCode::limit);
  }
  if (!(camera.lens_radius >= 0) || !(camera.focus_distance > 0))
    fail("the lens radius or the focus is negative");
  if (camera.lens_radius > kFarthest) {
    fail(fmt::format("the lens is wider than {:.0e} times the scene's size", kFarthest),
         ErrorCode::limit);
  }
}

bool has_light(const Scene& scene) {
  if (!scene.lights.empty() || !is_black(scene.environment.radiance)) return true;
  const auto emits = [&](const auto& shape) {
    return !is_black(scene.materials[static_cast<std::size_t>(shape.material)].emission);
  };
  return std::any_of(scene.meshes.begin(), scene.meshes.end(), emits) ||
         std::any_of(scene.spheres.begin(), scene.spheres.end(), emits);
}

}  // namespace

// Looks along -z at the middle of the scene, from far enough to see the sphere around its bounding
// box.
Camera automatic_camera(const Scene& scene) {
  Imath::Box3f box;
  for (const Mesh& mesh : scene.meshes) {
    for (const Vec3& p : mesh.positions) box.extendBy(p);
  }
  std::vector<Imath::Box3d> prototypes;
  for (const Mesh& mesh : scene.prototypes) prototypes.push_back(bounds_of(mesh));
  for (const Instance& instance : scene.instances) {
    const Imath::Box3d placed = bounds_of(prototypes[instance.prototype], instance);
    box.extendBy(Vec3(placed.min));
    box.extendBy(Vec3(placed.max));
  }
  for (const Sphere& sphere : scene.spheres) {
    box.extendBy(sphere.center - Vec3(sphere.radius));
    box.extendBy(sphere.center + Vec3(sphere.radius));
  }
  for (const Curves& curves : scene.curves) {
    for (const CurvePoint& p : curves.points) {
      box.extendBy(p.position - Vec3(p.radius));
      box.extendBy(p.position + Vec3(p.radius));
    }
  }
  Camera camera;
  camera.name = "automatic";
  camera.target = box.center();
  const float distance = 1.02f * box.size().length() / 2 / std::sin(camera.fov / 2);
  camera.eye = camera.target + Vec3(0, 0, distance);
  camera.focus_distance = distance;
  return camera;
}

void override_cameras(const SceneOverrides& o, Scene& scene) {
  if (o.eye || o.target || o.up) {
    // One pose on the command line is one camera: the first of the scene gives what is not said.
    scene.cameras.resize(1);
    Camera& camera = scene.cameras[0];
    if (o.eye) camera.eye = scene.space.local(*o.eye);
    if (o.target) camera.target = scene.space.local(*o.target);
    if (o.up) camera.up = unit(*o.up, "`up`");
  }
  if (o.fov && !(*o.fov > 0 && *o.fov < 180)) {
    misuse(fmt::format("`fov {}`: expected degrees between 0 and 180", *o.fov));
  }
  if (o.size) {
    for (const float side : {o.size->x, o.size->y}) {
      if (!(side >= 1 && side <= kMaxSide) || side != std::floor(side)) {
        misuse(fmt::format("`size {}x{}`: expected whole numbers of pixels from 1 to {}", o.size->x,
                           o.size->y, kMaxSide));
      }
    }
  }
  for (Camera& camera : scene.cameras) {
    if (o.size) {
      camera.width = static_cast<std::uint32_t>(o.size->x);
      camera.height = static_cast<std::uint32_t>(o.size->y);
    }
    if (o.fov) {
      camera.fov = *o.fov * kRadians;
    } else if (camera.vertical_fov > 0 && camera.height > 0) {
      const float aspect = static_cast<float>(camera.width) / static_cast<float>(camera.height);
      camera.fov = 2 * std::atan(std::tan(camera.vertical_fov / 2) * aspect);
    }
    if (o.shutter) camera.shutter = *o.shutter;
  }
  for (std::size_t i = 0; i < scene.cameras.size(); ++i)
    check_camera(scene.cameras[i], i, scene.name);
}

void apply_overrides(const SceneOverrides& overrides, Scene& scene) {
  if (scene.cameras.empty()) scene.cameras.push_back(automatic_camera(scene));
  override_cameras(overrides, scene);
  override_lights(overrides, scene);
  note_environment(scene);
  if (!has_light(scene)) {
    scene.warnings.push_back(scene.name +
                             ": nothing in the scene gives light; `sky` and `sun` add some");
  }
}

}  // namespace psf::render
