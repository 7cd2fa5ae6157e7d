// What moves while a shutter is open: found by loading a scene at several moments and comparing.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

#include "render/scene/load.h"
#include "render/scene/scene.h"

namespace psf::render {

// The step before a time of Scene::shutter, in [0, 1], and how far it is on the way to the next.
struct StepAt {
  std::size_t step;
  float share;
};
// `steps`: at least 2.
[[nodiscard]] inline StepAt step_at(std::size_t steps, float time) {
  const float place = time * static_cast<float>(steps - 1);
  const auto step = std::min(static_cast<std::size_t>(place), steps - 2);
  return {step, place - static_cast<float>(step)};
}

// Between the two steps of something that moves.
template <class T, class Of>
[[nodiscard]] auto at_time(const std::vector<T>& steps, float time, const Of& of) {
  const auto [step, share] = step_at(steps.size(), time);
  return of(steps[step]) * (1 - share) + of(steps[step + 1]) * share;
}

// A corner, and its normal as it is not yet of unit length, of a mesh that moves.
[[nodiscard]] inline Vec3 position_at(const Mesh& mesh, std::uint32_t corner, float time) {
  return at_time(mesh.motion, time, [corner](const MeshStep& m) { return m.positions[corner]; });
}
[[nodiscard]] inline Vec3 normal_at(const Mesh& mesh, std::uint32_t corner, float time) {
  return at_time(mesh.motion, time, [corner](const MeshStep& m) { return m.normals[corner]; });
}
[[nodiscard]] inline Ball ball_at(const std::vector<Ball>& steps, float time) {
  return {at_time(steps, time, [](const Ball& b) { return b.center; }),
          at_time(steps, time, [](const Ball& b) { return b.radius; })};
}

// The cameras of each step, before the command line's changes.
struct Motion {
  std::vector<std::vector<Camera>> cameras;
};

// Sets Scene::shutter and the motion of shapes; `places_at` loads the scene at a frame. Two steps
// are enough where nothing leaves the straight line by more than 2^-12 of the way it goes; else
// there are kSteps. Throws Error{bad_input} where a shape is not the same one at all moments.
constexpr std::size_t kSteps = 9;
[[nodiscard]] Motion find_motion(const SceneOverrides& overrides, Scene& scene,
                                 const std::function<Scene(double frame)>& places_at);
// Sets Camera::motion of the scene's final cameras.
void move_cameras(const SceneOverrides& overrides, const Motion& motion, Scene& scene);
// Sets the rest positions of shapes that are elsewhere at frame 0 or move now; `at_rest`: the scene
// at frame 0, which may be `scene`.
void keep_rest(Scene& scene, const Scene& at_rest);

// Whether shapes, or anything, move while the shutter is open.
[[nodiscard]] bool shapes_move(const Scene& scene);
[[nodiscard]] bool anything_moves(const Scene& scene);

}  // namespace psf::render
