// Cameras and lights of a glTF file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "render/scene/gltf/parts.h"

namespace psf::render {
namespace {

// The image of a direction, unit.
Vec3 turn(const Imath::M44d& m, const Imath::V3d& direction) {
  Imath::V3d turned;
  m.multDirMatrix(direction, turned);
  return Vec3(turned.normalized());
}

Vec3 place_of(const Imath::M44d& m) {
  return Vec3(Imath::V3d(m[3][0], m[3][1], m[3][2]));
}

}  // namespace

void add_gltf_camera(GltfLoad& load, const JsonCursor& index, const std::string& name,
                     const Imath::M44d& to_scene) {
  static constexpr std::string_view kTypes[] = {"perspective", "orthographic"};
  const JsonCursor json = load.element("cameras", index, "camera");
  load.check_keys(json, {"type", "perspective", "orthographic"});
  if (json.at("type").choice(kTypes) != 0)
    return load.leave_out("orthographic cameras are left out", gltf_place(json));
  const JsonCursor lens = json.at("perspective");
  load.check_keys(lens, {"aspectRatio", "yfov", "zfar", "znear"});
  const float yfov =
      lens.at("yfov").number({1e-4, std::numbers::pi - 1e-4, "of radians in (0, pi)"});
  for (const char* key : {"znear", "zfar"}) {
    if (const auto distance = lens.find(key)) (void)distance->number(kPositive);
  }
  Camera camera;
  const auto own_name = json.find("name");
  camera.name = own_name && !own_name->text().empty() ? own_name->text() : name;
  camera.eye = place_of(to_scene);
  camera.target = camera.eye + turn(to_scene, {0, 0, -1});
  camera.up = turn(to_scene, {0, 1, 0});
  if (const auto aspect_json = lens.find("aspectRatio")) {
    const double aspect = aspect_json->number({1e-4, 1e4, "from 0.0001 to 10000"});
    camera.height = static_cast<std::uint32_t>(
        std::lround(std::clamp(camera.width / aspect, 1.0, double{kMaxSide})));
    camera.fov = static_cast<float>(2 * std::atan(std::tan(double{yfov} / 2) * aspect));
  } else {
    camera.fov = camera.vertical_fov = yfov;  // the picture is a square unless another is asked for
  }
  load.scene.cameras.push_back(std::move(camera));
}

void add_gltf_light(GltfLoad& load, const JsonCursor& index, const Imath::M44d& to_scene) {
  static constexpr std::string_view kTypes[] = {"point", "directional", "spot"};  // as LightKind
  const auto all = find_extension(load.root(), "KHR_lights_punctual");
  const auto lights = all ? all->find("lights") : std::nullopt;
  const std::uint64_t i = index.whole();
  if (!lights || i >= lights->size()) index.fail(fmt::format("there is no light {}", i));
  const JsonCursor json = lights->item(static_cast<std::size_t>(i));
  load.check_keys(json, {"color", "intensity", "range", "spot", "type"});
  Light light;
  light.kind = static_cast<LightKind>(json.at("type").choice(kTypes));
  light.name = gltf_name(json, "light", static_cast<std::size_t>(i));
  light.position = place_of(to_scene);
  light.direction = turn(to_scene, {0, 0, -1});
  const auto intensity = json.find("intensity"), colour = json.find("color");
  const float strength = intensity ? intensity->number(kNonNegative) : 1;
  light.intensity = (colour ? to_rgb(colour->numbers(3, kNonNegative)) : Rgb(1)) * strength;
  if (const auto range = json.find("range")) {
    (void)range->number(kPositive);
    load.leave_out("the range of lights is left out, they reach everywhere", gltf_place(json));
  }
  if (light.kind == LightKind::spot) {
    const JsonCursor spot = json.at("spot");
    load.check_keys(spot, {"innerConeAngle", "outerConeAngle"});
    constexpr Range kAngle{0, std::numbers::pi / 2 + 1e-6, "of radians in [0, pi/2]"};
    const auto inner_json = spot.find("innerConeAngle"), outer_json = spot.find("outerConeAngle");
    const double outer =
        std::max(1e-4, outer_json ? double{outer_json->number(kAngle)} : std::numbers::pi / 4);
    const double inner = inner_json ? double{inner_json->number(kAngle)} : 0;
    if (inner > outer) inner_json->fail("the inner angle is larger than the outer one");
    light.cos_inner = static_cast<float>(std::cos(inner));
    light.cos_outer = static_cast<float>(std::max(0.0, std::cos(outer)));
  }
  load.scene.lights.push_back(std::move(light));
}

}  // namespace psf::render
