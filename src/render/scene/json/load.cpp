// The JSON scene file: cameras, environment and lights; the rest is in json_*.cpp.
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/error.h"
#include "render/scene/json/file.h"
#include "render/scene/json/parts.h"

namespace psf::render {
namespace {

constexpr Range kShutterRange{-1, 1, "of frames in [-1, 1]"};

Shutter read_shutter(const JsonCursor& json) {
  const auto items = json.items();
  if (items.size() != 2) json.expected("an array of two numbers of frames, open and close");
  const Shutter shutter{items[0].number(kShutterRange), items[1].number(kShutterRange)};
  if (shutter.close < shutter.open) json.fail("the shutter closes before it opens");
  return shutter;
}

Camera read_camera(const JsonCursor& json, Scene& scene) {
  const Space& space = scene.space;
  json.check_keys({"name", "eye", "target", "up", "fov", "size", "lens_radius", "focus_distance",
                   "shutter", "keyframes"});
  Camera camera;
  if (const auto name = json.find("name")) camera.name = name->text();
  camera.eye = space.local(json.at("eye").vec3d());
  camera.target = space.local(json.at("target").vec3d());
  if (const auto up = json.find("up")) camera.up = up->direction();
  if (const auto fov = json.find("fov")) {
    camera.fov = fov->number(kFovRange) * kRadians;
  }
  if (const auto size = json.find("size")) {
    const auto items = size->items();
    if (items.size() != 2) size->expected("an array of two numbers of pixels, width and height");
    camera.width = items[0].integer(1, kMaxSide);
    camera.height = items[1].integer(1, kMaxSide);
  }
  if (const auto radius = json.find("lens_radius"))
    camera.lens_radius = space.local_length(radius->real(kNonNegative));
  if (const auto shutter = json.find("shutter")) camera.shutter = read_shutter(*shutter);
  const auto focus = json.find("focus_distance"), keys = json.find("keyframes");
  if (focus) camera.focus_distance = space.local_length(focus->real(kPositive));
  const bool focused = keys && move_camera(*keys, scene, camera);
  if (!focus && !focused) camera.focus_distance = (camera.target - camera.eye).length();
  return camera;
}

Environment read_environment(const JsonCursor& json, JsonLoad& load) {
  json.check_keys({"radiance", "map", "rotation"});
  Environment environment;
  if (const auto map = json.find("map")) {
    environment.texture = load.textures.load(map->file(), map->text(), TextureUse::radiance,
                                             [&] { return map->where(); });
    environment.radiance = Rgb(1);
  }
  if (const auto radiance = json.find("radiance"))
    environment.radiance = radiance->rgb(kNonNegative);
  if (const auto rotation = json.find("rotation"))
    environment.rotation = rotation->number() * kRadians;
  return environment;
}

// The direction in which a light travels: "direction", or from its position to "target".
Vec3 read_direction(const JsonCursor& json, const Imath::V3d& position, const Space& space) {
  const auto target = json.find("target");
  if (!target) return json.at("direction").direction();
  if (json.find("direction"))
    json.fail("has both \"direction\" and \"target\", one of them is enough");
  const Imath::V3d at = target->vec3d();
  const Vec3 direction = space.exact ? Vec3(at - position) : Vec3(at) - Vec3(position);
  if (!(direction.length() > 0)) target->fail("the target is where the light is");
  return direction.normalized();
}

Light read_light(const JsonCursor& json, const Space& space) {
  static constexpr std::string_view kKinds[] = {"point", "directional", "spot"};
  Light light;
  light.kind = static_cast<LightKind>(json.at("kind").choice(kKinds));
  switch (light.kind) {
    case LightKind::point:
      json.check_keys({"name", "kind", "position", "intensity"});
      light.position = space.local(json.at("position").vec3d());
      light.intensity = json.at("intensity").rgb(kNonNegative);
      break;
    case LightKind::directional:
      json.check_keys({"name", "kind", "direction", "irradiance", "angle"});
      light.direction = json.at("direction").direction();
      light.intensity = json.at("irradiance").rgb(kNonNegative);
      if (const auto angle = json.find("angle")) {
        light.angle = angle->number({0, 90, "of degrees in [0, 90]"}) * kRadians;
      }
      break;
    case LightKind::spot: {
      json.check_keys(
          {"name", "kind", "position", "direction", "target", "intensity", "inner", "outer"});
      light.position = space.local(json.at("position").vec3d());
      light.direction = read_direction(json, json.at("position").vec3d(), space);
      light.intensity = json.at("intensity").rgb(kNonNegative);
      const float outer = json.at("outer").number({0.01, 90, "of degrees in (0, 90]"});
      const auto inner = json.find("inner");
      const float inner_degrees = inner ? inner->number({0, 90, "of degrees in [0, 90]"}) : 0.0f;
      if (inner_degrees > outer) inner->fail("the inner angle is larger than the outer one");
      light.cos_inner = std::cos(inner_degrees * kRadians);
      light.cos_outer = std::cos(outer * kRadians);
      break;
    }
  }
  if (const auto name = json.find("name")) light.name = name->text();
  return light;
}

}  // namespace

void load_json(const std::string& path, Scene& scene) {
  const nlohmann::json document = read_json(path);
  const JsonCursor root(document, path);
  root.check_keys({"cameras", "environment", "media", "medium", "materials", "shapes", "lights"});
  JsonLoad load(scene);
  for (const JsonCursor& camera : root.items("cameras"))
    scene.cameras.push_back(read_camera(camera, scene));
  if (scene.moment.parts == Moment::Parts::cameras) return;
  if (const auto environment = root.find("environment")) {
    scene.environment = read_environment(*environment, load);
  }
  for (const JsonCursor& medium : root.items("media")) read_medium(medium, scene);
  if (root.find("medium")) scene.medium = read_medium_name(root, "medium", scene);
  for (const JsonCursor& material : root.items("materials")) read_material(material, load);
  for (const JsonCursor& light : root.items("lights")) {
    scene.lights.push_back(read_light(light, scene.space));
  }
  for (const JsonCursor& shape : root.items("shapes")) {
    read_shape(shape, {scene.space.to_local()}, load);
  }
}

}  // namespace psf::render
