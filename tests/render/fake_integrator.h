// An integrator without a scene: records made of hashes of the ray and of the sampler's numbers, so
// that the loop can be tested without light transport.
#pragma once

#include <cmath>

#include "render/light/integrator.h"

namespace psf::tests {

class FakeIntegrator : public render::Integrator {
 public:
  render::PathRecord trace(const render::Ray& ray, render::Sampler& sampler, bool shade,
                           std::uint64_t& rays, const render::PathDetails&) const override {
    rays += 3;
    render::PathRecord record;
    const Vec2 u = sampler.next_2d();
    record.unfiltered = Rgb(u.x, 0.25f, 1);
    record.has_vertex = ray.direction.x > -0.2f;  // the picture's left has background alone
    if (!record.has_vertex) return record;
    record.coverage = 1;
    record.shaded = shade;
    record.distance = 2 + u.y;
    record.position = ray.origin + ray.direction * record.distance;
    record.normal = -ray.direction;
    record.direction = -ray.direction;
    record.reflectance = Rgb(0.5f, u.x, 0.25f);
    record.throughput = Rgb(1, 0.5f, u.y);
    if (shade) record.contribution = Rgb(sampler.next_1d(), 2, 0.125f);
    record.visibility = u.x > 0.5f ? 5 : 2;
    record.hit_distance = u.y > 0.9f ? std::numeric_limits<float>::infinity() : u.y;
    record.material = 7;
    record.roughness = 0.75f;
    return record;
  }
  std::vector<std::string> light_names() const override { return {"lamp", "sun"}; }
  const std::vector<render::LayerInfo>& layers() const override { return none_; }

 private:
  std::vector<render::LayerInfo> none_;
};

inline render::Scene two_camera_scene() {
  render::Scene scene;
  scene.name = "fake.json";
  scene.hash = "0123abcd";
  render::Camera left;
  left.name = "left";
  left.width = 96;
  left.height = 64;
  render::Camera right = left;
  right.name = "right";
  right.eye = Vec3(1, 0, 0);
  right.target = Vec3(1, 0, -1);
  right.width = 50;
  right.height = 40;
  scene.cameras = {left, right};
  return scene;
}

}  // namespace psf::tests
