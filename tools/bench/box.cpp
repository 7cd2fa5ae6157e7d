// The made-up box of make_box(): closed-form intersections, one record after the other.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "bench/sample.h"

namespace psf::bench {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
// x and z in [-1, 1], y in [0, 2], open toward the camera.
const Vec3 kEye(0, 1, 4.2f);
constexpr float kTanHalfFov = 0.31f;  // all rays enter the box
constexpr float kLampHalf = 0.28f, kLampHeight = 1.99f;
const Rgb kWhite(0.74f, 0.73f, 0.70f), kRed(0.62f, 0.06f, 0.05f), kGreen(0.12f, 0.46f, 0.10f);
const Rgb kEmission(20, 17, 13);

struct Ball {
  Vec3 center;
  float radius;
};
const Ball kBalls[] = {{Vec3(-0.46f, 0.38f, -0.42f), 0.38f}, {Vec3(0.45f, 0.34f, 0.32f), 0.34f}};

struct Hit {
  float t = kFar;
  Vec3 normal;
  Rgb reflectance;
  bool lamp = false;
};

// Where a ray with unit direction from outside enters the ball.
float enter(const Ball& ball, const Vec3& from, const Vec3& toward) {
  const Vec3 to_from = from - ball.center;
  const float b = dot(to_from, toward);
  const float root_sq = b * b - length_sq(to_from) + ball.radius * ball.radius;
  const float t = root_sq < 0 ? kFar : -b - std::sqrt(root_sq);
  return t > 0 ? t : kFar;
}

Hit walls(const Vec3& from, const Vec3& toward) {
  const Vec3 least(-1, 0, -1), most(1, 2, 1);
  Hit hit;
  for (int axis = 0; axis < 3; ++axis) {
    const bool up = toward[axis] > 0;
    const float t = ((up ? most : least)[axis] - from[axis]) / toward[axis];
    if (!(t < hit.t)) continue;
    hit.t = t;
    hit.normal = Vec3(0, 0, 0);
    hit.normal[axis] = up ? -1.0f : 1.0f;
  }
  hit.reflectance = hit.normal.x > 0 ? kRed : hit.normal.x < 0 ? kGreen : kWhite;
  return hit;
}

Hit first_hit(const Vec3& from, const Vec3& toward) {
  Hit hit = walls(from, toward);
  const float to_lamp = (kLampHeight - from.y) / toward.y;
  const Vec3 at_lamp = from + to_lamp * toward;
  if (toward.y > 0 && to_lamp < hit.t &&
      std::max(std::abs(at_lamp.x), std::abs(at_lamp.z)) < kLampHalf) {
    hit.t = to_lamp;
    hit.lamp = true;
  }
  for (const Ball& ball : kBalls) {
    const float t = enter(ball, from, toward);
    if (t >= hit.t) continue;
    hit = {t, (from + t * toward - ball.center) / ball.radius, kWhite, false};
  }
  return hit;
}

// One path after the other.
class Painter {
 public:
  Painter(std::size_t side, run::BlockRecords& out) : side_(side), out_(out) {}

  void add_path(std::size_t pixel) {
    const auto column = static_cast<float>(pixel % side_), row = static_cast<float>(pixel / side_);
    const float scale = 2 * kTanHalfFov / static_cast<float>(side_);
    const float right = (column + unit()) * scale - kTanHalfFov;
    const float up = kTanHalfFov - (row + unit()) * scale;
    const Vec3 toward = Vec3(right, up, -1).normalized();
    const Hit hit = first_hit(kEye, toward);
    const Vec3 x = kEye + hit.t * toward;
    out_.flags.push_back(hit.lamp ? 0 : filter::kHasVertex | filter::kShaded);
    out_.pixel.push_back(static_cast<std::uint32_t>(pixel));
    out_.position.push_back(x);
    out_.normal.push_back(hit.normal);
    out_.reflectance.push_back(hit.reflectance);
    out_.distance.push_back(hit.t);
    out_.throughput.emplace_back(1, 1, 1);
    out_.unfiltered.push_back(hit.lamp ? kEmission : Rgb(0, 0, 0));
    const float direct = hit.lamp ? 0 : from_lamp(x, hit.normal);
    out_.visibility.push_back(direct > 0 ? 1 : 0);
    const float bounced = -0.3f * std::log(1 - unit());  // light that is found by chance
    out_.contribution.push_back(hit.reflectance * (direct * kEmission + Rgb(1, 1, 1) * bounced));
  }

 private:
  float unit() { return std::uniform_real_distribution<float>(0, 1)(random_); }

  // Light from a random point of the lamp, over its emission and the albedo.
  float from_lamp(const Vec3& x, const Vec3& normal) {
    const Vec3 point((2 * unit() - 1) * kLampHalf, kLampHeight, (2 * unit() - 1) * kLampHalf);
    const float distance = (point - x).length();
    const Vec3 toward = (point - x) / distance;
    const float cosines = std::max(0.0f, dot(normal, toward)) * std::max(0.0f, toward.y);
    for (const Ball& ball : kBalls) {
      if (enter(ball, x, toward) < distance) return 0;
    }
    const float area = 4 * kLampHalf * kLampHalf;
    return cosines * area / (std::numbers::pi_v<float> * distance * distance);
  }

  std::size_t side_;
  run::BlockRecords& out_;
  std::minstd_rand random_{1};
};

}  // namespace

Sample make_box(std::size_t records) {
  constexpr std::size_t kPasses = 4;
  const auto side =
      std::max(std::size_t{1},
               static_cast<std::size_t>(std::sqrt(static_cast<double>(records) / double{kPasses})));
  const std::size_t pixels = side * side;
  Sample sample;
  sample.parameters.radius.delta = 0;
  sample.parameters.weights.gloss.reset();  // all is diffuse
  sample.cameras = {{static_cast<std::uint32_t>(side), static_cast<std::uint32_t>(side),
                     2 * double{kTanHalfFov} / static_cast<double>(side)}};
  Painter painter(side, sample.records);
  for (std::size_t i = 0; i < records; ++i) painter.add_path(i % pixels);
  for (std::size_t p = 0; p * pixels <= records; ++p) sample.passes.push_back(p * pixels);
  return sample;
}

}  // namespace psf::bench
