// All light sources of a scene: where each shines, and how brightly, for choices by place.
#include "render/light/frame.h"
#include "render/light/lights.h"

namespace psf::render {
namespace {

// Of the scene's radius: no light brings more from nearer by.
constexpr float kNearestOfRadius = 1e-6f;
// Meshes of more triangles are sampled by what these may bring.
constexpr std::size_t kFewTriangles = 2;
// Of what comes from everywhere a surface receives a fourth.
constexpr double kOfSphere = 0.25;

Imath::Box3f ball_box(const Vec3& center, float radius) {
  return {center - Vec3(radius, radius, radius), center + Vec3(radius, radius, radius)};
}

void extend_by_triangle(const std::vector<Vec3>& positions,
                        const std::array<std::uint32_t, 3>& triangle, Imath::Box3f& box) {
  for (const std::uint32_t corner : triangle) box.extendBy(positions[corner]);
}

}  // namespace

float Lights::choose_triangle(const Record& light, const Receiver& at, float& u,
                              std::size_t& k) const {
  if (light.tree == kNone) {
    k = light.areas.sample(u);
    return light.extent;
  }
  float probability;
  k = trees_[static_cast<std::size_t>(light.tree)].sample(at, u, probability);
  return area_density(light, k, probability);
}

float Lights::area_density(const Record& light, std::size_t k, float probability) const {
  const Triangle& triangle = triangles_[light.first + k];
  const float area = 0.5f * TriangleNormal(triangle.edge1, triangle.edge2).size;
  return area > 0 ? probability / area : 0;
}

LightBounds Lights::bounds_of(Record& light, double intensity, float nearest) {
  LightBounds bounds;
  bounds.intensity = static_cast<float>(intensity);
  if (light.kind == Kind::point || light.kind == Kind::spot) {
    bounds.box = Imath::Box3f(light.position);
    if (light.kind == Kind::point) return bounds;
    bounds.axis = light.direction;
    // Full light within the inner angle, then less of it up to the outer one.
    bounds.cos_normals = light.cos_inner;
    bounds.cos_spread = std::cos(std::acos(light.cos_outer) - std::acos(light.cos_inner)) - 1e-5f;
    return bounds;
  }
  if (light.kind == Kind::sphere) {
    bounds.box = ball_box(light.position, light.extent);
    if (light.sphere == nullptr) return bounds;
    for (const Ball& ball : light.sphere->motion)
      bounds.box.extendBy(ball_box(ball.center, ball.radius));
    return bounds;
  }
  const Mesh& mesh = *light.mesh;
  const bool all_around = light.both_sides || !mesh.motion.empty();
  std::vector<LightBounds> triangles(mesh.triangles.size());
  LightBounds whole;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    LightBounds& triangle = triangles[k];
    extend_by_triangle(mesh.positions, mesh.triangles[k], triangle.box);
    for (const MeshStep& step : mesh.motion)
      extend_by_triangle(step.positions, mesh.triangles[k], triangle.box);
    triangle.intensity = static_cast<float>(intensity * double{light.areas.probability(k)});
    if (!all_around) {
      triangle.axis = triangles_[light.first + k].normal;
      triangle.cos_normals = 1;
      triangle.cos_spread = -1e-5f;
    }
    whole = join(whole, triangle);
  }
  if (triangles.size() > kFewTriangles) {
    light.tree = static_cast<int>(trees_.size());
    trees_.emplace_back(triangles, nearest);
  }
  return whole;
}

void Lights::place(const std::vector<float>& powers, float radius) {
  const double disk = double{kPi} * double{radius} * double{radius};
  std::vector<double> intensities(count(), 0);
  std::vector<PlacedChoice::Distant> far;
  // What all of it brings to the middle of the scene from its rim, so that numbers are moderate.
  double unit = 0;
  for (std::size_t l = 0; l < powers.size(); ++l) {
    const double power = double{powers[l]};
    if (l == count() || lights_[l].kind == Kind::directional || lights_[l].kind == Kind::sun) {
      unit += power / disk;
      continue;
    }
    const Record& light = lights_[l];
    double intensity = double{luminance(light.radiance)};  // of points and spots
    if (light.kind == Kind::mesh) intensity = power / double{kPi};
    if (light.kind == Kind::sphere) intensity = power / (4 * double{kPi});
    if (light.both_sides) intensity /= 2;
    intensities[l] = intensity;
    unit += intensity / (double{radius} * double{radius});
  }
  std::vector<LightBounds> near(count());
  const float nearest = kNearestOfRadius * radius;
  for (std::size_t l = 0; l < powers.size(); ++l) {
    if (!(unit > 0)) break;
    const auto irradiance = static_cast<float>(double{powers[l]} / disk / unit);
    if (l == count()) {
      far.push_back({l, Vec3(0, 0, 0), 1, static_cast<float>(kOfSphere * double{irradiance})});
    } else if (lights_[l].kind == Kind::directional || lights_[l].kind == Kind::sun) {
      far.push_back({l, lights_[l].direction, 1 - lights_[l].extent, irradiance});
    } else {
      near[l] = bounds_of(lights_[l], intensities[l] / unit, nearest);
    }
  }
  placed_.emplace(LightTree(near, nearest), std::move(far));
}

}  // namespace psf::render
