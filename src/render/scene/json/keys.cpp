// "keyframes" of the shapes and cameras of the JSON scene file.
#include "render/scene/keys.h"

#include <algorithm>
#include <numbers>

#include "render/scene/json/parts.h"

namespace psf::render {
namespace {

// The keys of an array "keyframes", and where the scene's frame lies among them.
struct Keys {
  std::vector<JsonCursor> items;
  Between at;  // eased
};

// What a key says is a part of the scene's hash, whatever frame is shown.
void note_key(Scene& scene, std::initializer_list<double> numbers) {
  scene.animation.insert(scene.animation.end(), numbers);
}

Keys read_keys(const JsonCursor& json, std::initializer_list<std::string_view> known,
               Scene& scene) {
  static constexpr std::string_view kEasings[] = {"linear", "step", "smooth"};  // as Easing
  std::vector<std::string_view> all(known);
  all.insert(all.end(), {"frame", "easing"});
  Keys keys{json.items(), {}};
  if (keys.items.empty()) json.expected("at least one key");
  std::vector<double> frames;
  std::vector<Easing> easings;
  for (const JsonCursor& key : keys.items) {
    key.check_keys(all);
    const JsonCursor frame = key.at("frame");
    frames.push_back(frame.real());
    if (frames.size() > 1 && !(frames.back() > frames[frames.size() - 2])) {
      frame.fail("the frames of keys must grow from key to key");
    }
    const auto easing = key.find("easing");
    easings.push_back(easing ? static_cast<Easing>(easing->choice(kEasings)) : Easing::linear);
    note_key(scene, {frames.back(), static_cast<double>(easings.back())});
  }
  keys.at = between(frames, scene.moment.frame);
  keys.at.share = eased(easings[keys.at.key], keys.at.share);
  return keys;
}

Pose read_pose(const JsonCursor& json, Scene& scene) {
  static constexpr std::string_view kAxes[] = {"x", "y", "z"};
  Pose pose;
  if (const auto scale = json.find("scale")) {
    pose.scale = scale->is_array() ? scale->vec3d() : Imath::V3d(scale->real());
    if (!(pose.scale.x > 0 && pose.scale.y > 0 && pose.scale.z > 0)) {
      scale->expected("scales above 0");
    }
  }
  const auto rotate = json.find("rotate"), axis = json.find("axis");
  if (axis && !rotate) json.fail("\"axis\" belongs to \"rotate\"");
  if (rotate) {
    const JsonCursor around = json.at("axis");
    Imath::V3d direction(0, 0, 0);
    if (around.is_text()) {
      direction[static_cast<int>(around.choice(kAxes))] = 1;
    } else {
      direction = Imath::V3d(around.direction());
    }
    pose.rotation.setAxisAngle(direction, rotate->real() * std::numbers::pi / 180);
  }
  if (const auto translate = json.find("translate")) pose.translation = translate->vec3d();
  const Imath::Quatd& q = pose.rotation;
  note_key(scene, {pose.scale.x, pose.scale.y, pose.scale.z, q.r, q.v.x, q.v.y, q.v.z,
                   pose.translation.x, pose.translation.y, pose.translation.z});
  return pose;
}

// A camera as a key has it; what the key leaves out is as at the key before.
void read_key(const JsonCursor& json, const Space& space, Camera& camera) {
  if (const auto eye = json.find("eye")) camera.eye = space.local(eye->vec3d());
  if (const auto target = json.find("target")) camera.target = space.local(target->vec3d());
  if (const auto up = json.find("up")) camera.up = up->direction();
  if (const auto fov = json.find("fov")) camera.fov = fov->number(kFovRange) * kRadians;
  if (const auto focus = json.find("focus_distance")) {
    camera.focus_distance = space.local_length(focus->real(kPositive));
  }
}

}  // namespace

Placement read_keyed_placement(const JsonCursor& json, Scene& scene) {
  const Keys keys = read_keys(json, {"translate", "rotate", "axis", "scale"}, scene);
  std::vector<Pose> poses;
  poses.reserve(keys.items.size());
  for (const JsonCursor& key : keys.items) poses.push_back(read_pose(key, scene));
  const std::size_t next = std::min(keys.at.key + 1, poses.size() - 1);
  const Placement m = mix(poses[keys.at.key], poses[next], keys.at.share).matrix();
  return scene.space.exact ? m : Placement(Mat4(m));
}

bool move_camera(const JsonCursor& json, Scene& scene, Camera& camera) {
  const Keys keys = read_keys(json, {"eye", "target", "up", "fov", "focus_distance"}, scene);
  std::vector<Camera> cameras;
  Camera at = camera;
  for (const JsonCursor& key : keys.items) {
    read_key(key, scene.space, at);
    cameras.push_back(at);
    note_key(scene, {double{at.fov}, double{at.focus_distance}});
    for (const Vec3& v : {at.eye, at.target, at.up}) {
      note_key(scene, {double{v.x}, double{v.y}, double{v.z}});
    }
  }
  const Camera& a = cameras[keys.at.key];
  const Camera& b = cameras[std::min(keys.at.key + 1, cameras.size() - 1)];
  camera.set_pose(mix(a.pose(), b.pose(), static_cast<float>(keys.at.share)));
  return std::any_of(keys.items.begin(), keys.items.end(),
                     [](const JsonCursor& key) { return key.find("focus_distance").has_value(); });
}

}  // namespace psf::render
