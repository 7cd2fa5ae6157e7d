// Which of many lights is sampled from a place.
#include "render/light/placed_choice.h"

#include <algorithm>
#include <cmath>

namespace psf::render {
namespace {

// Of what is near and what is far neither gets less than this where light may come from both: how
// much a large cluster brings is known only roughly.
constexpr float kLeastSide = 0.25f;
// Of what all lights bring, for each of the others of a plan, for the same reason.
constexpr float kLeastWeight = 0x1p-8f;

}  // namespace

float PlacedChoice::irradiance(const Receiver& at, const Distant& light) const {
  if (at.normal == Vec3(0, 0, 0) || light.direction == Vec3(0, 0, 0)) return light.irradiance;
  const float cosine = std::clamp(dot(at.normal, light.direction), -1.0f, 1.0f);
  if (cosine >= light.cos_radius) return light.irradiance;
  // Its edge may be above the horizon where its middle is not.
  const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
  const float sine_radius = std::sqrt(std::max(0.0f, 1 - light.cos_radius * light.cos_radius));
  return light.irradiance * std::max(0.0f, cosine * light.cos_radius + sine * sine_radius);
}

float PlacedChoice::near_share(const Receiver& at, float& far) const {
  const float near = near_.importance(at);
  far = 0;
  for (const Distant& light : far_) far += irradiance(at, light);
  if (!(near > 0)) return far > 0 ? 0.0f : -1.0f;
  if (!(far > 0)) return 1;
  return std::clamp(near / (near + far), kLeastSide, 1 - kLeastSide);
}

std::size_t PlacedChoice::choose(const Receiver& at, float u, float& probability) const {
  float far;
  const float near = near_share(at, far);
  probability = 0;
  if (near < 0) return 0;
  if (u < near) {
    u = std::min(u / near, 0x1.fffffep-1f);
    const std::size_t light = near_.sample(at, u, probability);
    probability *= near;
    return light;
  }
  float left = (u - near) / (1 - near) * far;
  const Distant* chosen = nullptr;
  for (const Distant& light : far_) {
    const float brings = irradiance(at, light);
    if (!(brings > 0)) continue;
    chosen = &light;
    probability = (1 - near) * (brings / far);
    if (left < brings) break;
    left -= brings;
  }
  return chosen == nullptr ? 0 : chosen->light;
}

float PlacedChoice::probability(const Receiver& at, std::size_t light) const {
  float far;
  const float near = near_share(at, far);
  if (near < 0) return 0;
  for (const Distant& distant : far_) {
    if (distant.light == light) return (1 - near) * (irradiance(at, distant) / far);
  }
  return near > 0 ? near * near_.probability(at, light) : 0;
}

PlacedChoice::Plan PlacedChoice::plan(const Receiver& at) const {
  Plan plan;
  const LightTree::Cut cut = near_.cut(at);
  float all = cut.importance;
  for (const Distant& light : far_) all += irradiance(at, light);
  if (!(all > 0)) return plan;
  plan.floor = kLeastWeight * all;
  const auto weigh = [&](float brings) { plan.rest += std::max(brings, plan.floor); };
  const auto is_strong = [&](float brings) {
    return brings >= kStrong * all && plan.count < plan.strong.size();
  };
  for (std::size_t k = 0; k < cut.count; ++k) {
    const LightTree::Cluster& cluster = cut.clusters[k];
    if (near_.is_single(cluster) && is_strong(cluster.importance)) {
      plan.strong[plan.count++] = near_.emitter(cluster);
      continue;
    }
    plan.others.clusters[plan.others.count++] = cluster;
    weigh(cluster.importance);
  }
  for (const Distant& light : far_) {
    const float brings = irradiance(at, light);
    if (is_strong(brings)) {
      plan.strong[plan.count++] = light.light;
    } else if (brings > 0) {
      weigh(brings);
    }
  }
  return plan;
}

std::size_t PlacedChoice::choose_rest(const Receiver& at, const Plan& plan, float u,
                                      float& probability) const {
  probability = 0;
  float left = u * plan.rest;
  for (std::size_t k = 0; k < plan.others.count; ++k) {
    const LightTree::Cluster& cluster = plan.others.clusters[k];
    const float weight = std::max(cluster.importance, plan.floor);
    if (left < weight) {
      float within = std::min(left / weight, 0x1.fffffep-1f);
      const std::size_t light = near_.sample(at, within, probability, cluster.node);
      probability *= weight / plan.rest;
      return light;
    }
    left -= weight;
  }
  // What rounding leaves over chooses none.
  for (const Distant& light : far_) {
    const float brings = irradiance(at, light);
    if (!(brings > 0) || plan.is_strong(light.light)) continue;
    const float weight = std::max(brings, plan.floor);
    if (left < weight) {
      probability = weight / plan.rest;
      return light.light;
    }
    left -= weight;
  }
  return 0;
}

float PlacedChoice::expected(const Receiver& at, std::size_t light) const {
  const Plan plan = this->plan(at);
  if (plan.is_strong(light)) return 1;
  for (const Distant& distant : far_) {
    if (distant.light != light) continue;
    const float brings = irradiance(at, distant);
    return brings > 0 ? std::max(brings, plan.floor) / plan.rest : 0;
  }
  const std::size_t k = near_.holder(plan.others, light);
  if (k == plan.others.count) return 0;
  const LightTree::Cluster& cluster = plan.others.clusters[k];
  return near_.probability(at, light, cluster.node) *
         (std::max(cluster.importance, plan.floor) / plan.rest);
}

}  // namespace psf::render
