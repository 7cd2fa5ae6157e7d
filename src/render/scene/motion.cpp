#include "render/scene/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "render/scene/load_parts.h"

namespace psf::render {
namespace {

constexpr float kStraight = 0x1p-12f;  // deviation from a straight line, of its length

using Steps = std::vector<Scene>;

// What asks for the same shapes at two moments, and how to do without it.
struct Purpose {
  const char *what, *remedy;
};
constexpr Purpose kMotion{"motion", "close the shutter"};
constexpr Purpose kRest{"rest positions", "leave the channel rest_position out"};

void check_same_shapes(const Scene& scene, const Scene& other, const Purpose& purpose) {
  const auto fail_shape = [&](const std::string& name, const char* what) {
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: shape {}: {}, so it has no {}; {}, or change its keys", scene.name,
                            name, what, purpose.what, purpose.remedy));
  };
  constexpr char kOutside[] = "it moves out of all bounds";
  const auto shapes = [](const Scene& s) { return s.meshes.size() + s.spheres.size(); };
  if (other.meshes.size() != scene.meshes.size() || other.spheres.size() != scene.spheres.size()) {
    const Scene& fewer = shapes(other) < shapes(scene) ? other : scene;
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: some of its shapes are not there at frame {}, so they have no {}; "
                            "scale none to nothing, or {}",
                            scene.name, fewer.moment.frame, purpose.what, purpose.remedy));
  }
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh &a = scene.meshes[m], &b = other.meshes[m];
    if (a.positions.size() != b.positions.size() || a.normals.size() != b.normals.size() ||
        a.triangles != b.triangles) {
      fail_shape(a.name, "its triangles are others from moment to moment");
    }
    for (const Vec3& p : b.positions) {
      if (!is_finite(p) || !in_space(p)) fail_shape(a.name, kOutside);
    }
  }
  for (const Sphere& s : other.spheres) {
    if (!is_finite(s.center) || !in_space(s.center) || !(s.radius <= kFarthest))
      fail_shape(s.name, kOutside);
  }
}

// Curves have no motion of their own, and instances none either: what keys move is no instance.
void check_still(const Scene& a, const Scene& b, const Purpose& purpose) {
  const auto same_points = [](const Curves& one, const Curves& other) {
    return one.points == other.points;
  };
  const auto same_placement = [](const Instance& one, const Instance& other) {
    return one.placement == other.placement;
  };
  if (std::ranges::equal(a.curves, b.curves, same_points) &&
      std::ranges::equal(a.instances, b.instances, same_placement)) {
    return;
  }
  throw Error(ErrorCode::bad_input,
              fmt::format("{}: curves move, but only meshes and spheres have {}; {}", a.name,
                          purpose.what, purpose.remedy));
}

// Whether `there` is off the straight line, on which it would be a `share` of the way from a to b.
bool bends(const Vec3& a, const Vec3& there, const Vec3& b, float share) {
  return (there - (a + (b - a) * share)).length() > kStraight * (b - a).length();
}
bool bends(const Ball& a, const Ball& there, const Ball& b, float share) {
  return bends(a.center, there.center, b.center, share) ||
         std::abs(there.radius - (a.radius + (b.radius - a.radius) * share)) >
             kStraight * std::abs(b.radius - a.radius);
}
bool bends(const CameraPose& a, const CameraPose& there, const CameraPose& b, float) {
  return !(a == b && a == there);
}

Ball ball_of(const Sphere& sphere) {
  return {sphere.center, sphere.radius};
}

// Whether anything is off the straight line after this share of the time.
bool any_bends(const Scene& a, const Scene& there, const Scene& b, float share) {
  for (std::size_t m = 0; m < a.meshes.size(); ++m) {
    const auto &from = a.meshes[m].positions, &over = there.meshes[m].positions,
               &to = b.meshes[m].positions;
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (bends(from[i], over[i], to[i], share)) return true;
    }
  }
  for (std::size_t s = 0; s < a.spheres.size(); ++s) {
    if (bends(ball_of(a.spheres[s]), ball_of(there.spheres[s]), ball_of(b.spheres[s]), share))
      return true;
  }
  for (std::size_t c = 0; c < a.cameras.size(); ++c) {
    if (bends(a.cameras[c].pose(), there.cameras[c].pose(), b.cameras[c].pose(), share))
      return true;
  }
  return false;
}

// The scene at even steps of its shutter: 2 or kSteps of them.
Steps load_steps(const Scene& scene, const std::function<Scene(double frame)>& places_at) {
  const auto at = [&](std::size_t k) {
    const double share = static_cast<double>(k) / (kSteps - 1);
    const double open{scene.shutter.open}, close{scene.shutter.close};
    Scene step = places_at(scene.moment.frame + open + share * (close - open));
    check_same_shapes(scene, step, kMotion);
    check_still(scene, step, kMotion);
    return step;
  };
  // What eases from key to key, or goes there and back, is on the line in the middle, not before.
  constexpr std::size_t kLast = kSteps - 1;
  constexpr std::array kLooks{kLast / 4, kLast / 2};
  Steps steps(kSteps);
  steps.front() = at(0);
  steps.back() = at(kLast);
  for (const std::size_t k : kLooks) steps[k] = at(k);
  const bool straight = std::ranges::none_of(kLooks, [&](std::size_t k) {
    const float share = static_cast<float>(k) / kLast;
    return any_bends(steps.front(), steps[k], steps.back(), share);
  });
  for (std::size_t k = 1; k < kLast && !straight; ++k) {
    if (std::ranges::find(kLooks, k) == kLooks.end()) steps[k] = at(k);
  }
  if (straight) steps.erase(steps.begin() + 1, steps.end() - 1);
  return steps;
}

void move_shapes(Steps& steps, Scene& scene) {
  const auto moves = [&](const auto& place_in) {
    return std::any_of(steps.begin(), steps.end(),
                       [&](const Scene& step) { return place_in(step) != place_in(steps[0]); });
  };
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (!moves([m](const Scene& s) -> const auto& { return s.meshes[m].positions; })) continue;
    for (Scene& step : steps) {
      Mesh& there = step.meshes[m];
      scene.meshes[m].motion.push_back({std::move(there.positions), std::move(there.normals)});
    }
  }
  for (std::size_t k = 0; k < scene.spheres.size(); ++k) {
    if (!moves([k](const Scene& s) { return ball_of(s.spheres[k]); })) continue;
    for (const Scene& step : steps) scene.spheres[k].motion.push_back(ball_of(step.spheres[k]));
  }
}

}  // namespace

Motion find_motion(const SceneOverrides& overrides, Scene& scene,
                   const std::function<Scene(double frame)>& places_at) {
  Shutter around = overrides.shutter.value_or(Shutter{});
  for (std::size_t c = 0; c < scene.cameras.size() && !overrides.shutter; ++c) {
    const Shutter& own = scene.cameras[c].shutter;
    around =
        c == 0 ? own : Shutter{std::min(around.open, own.open), std::max(around.close, own.close)};
  }
  Motion motion;
  if (!around.blurs()) return motion;
  scene.shutter = around;
  Steps steps = load_steps(scene, places_at);
  move_shapes(steps, scene);
  for (Scene& step : steps) motion.cameras.push_back(std::move(step.cameras));
  return motion;
}

void move_cameras(const SceneOverrides& overrides, const Motion& motion, Scene& scene) {
  if (motion.cameras.empty() || motion.cameras[0].empty()) return;
  for (const std::vector<Camera>& cameras : motion.cameras) {
    Scene step;
    step.name = scene.name;
    step.space = scene.space;
    step.cameras = cameras;
    override_cameras(overrides, step);
    for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
      scene.cameras[c].motion.push_back(step.cameras[c].pose());
    }
  }
  for (Camera& camera : scene.cameras) {
    const auto same = [&](const CameraPose& pose) { return pose == camera.motion[0]; };
    if (std::all_of(camera.motion.begin(), camera.motion.end(), same)) camera.motion.clear();
  }
}

void keep_rest(Scene& scene, const Scene& at_rest) {
  if (&scene != &at_rest) check_same_shapes(scene, at_rest, kRest);
  check_still(scene, at_rest, kRest);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    Mesh& mesh = scene.meshes[m];
    const std::vector<Vec3>& rest = at_rest.meshes[m].positions;
    if (!mesh.motion.empty() || rest != mesh.positions) mesh.rest = rest;
  }
  for (std::size_t k = 0; k < scene.spheres.size(); ++k) {
    Sphere& sphere = scene.spheres[k];
    const Ball rest = ball_of(at_rest.spheres[k]);
    if (!sphere.motion.empty() || rest != ball_of(sphere)) sphere.rest = rest;
  }
}

bool shapes_move(const Scene& scene) {
  const auto moves = [](const auto& shape) { return !shape.motion.empty(); };
  return std::any_of(scene.meshes.begin(), scene.meshes.end(), moves) ||
         std::any_of(scene.spheres.begin(), scene.spheres.end(), moves);
}

bool anything_moves(const Scene& scene) {
  return shapes_move(scene) ||
         std::any_of(scene.cameras.begin(), scene.cameras.end(),
                     [](const Camera& camera) { return !camera.motion.empty(); });
}

CameraPose mix(const CameraPose& a, const CameraPose& b, float share) {
  if (share == 0 || a == b) return a;
  const Vec3 up = a.up * (1 - share) + b.up * share;
  return {a.eye * (1 - share) + b.eye * share, a.target * (1 - share) + b.target * share,
          up.length() > 0 ? up.normalized() : a.up, a.fov * (1 - share) + b.fov * share,
          a.focus_distance * (1 - share) + b.focus_distance * share};
}

void Camera::set_pose(const CameraPose& pose) {
  eye = pose.eye;
  target = pose.target;
  up = pose.up;
  fov = pose.fov;
  focus_distance = pose.focus_distance;
}

}  // namespace psf::render
