// A hierarchy of many emitters: what its nodes may bring, and the way down.
#include "render/light/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace psf::render {
namespace {

// A child that light may come from has at least this probability: what a cluster brings is not
// known exactly, and no light may be left out because another cluster is strong.
constexpr float kLeastShare = 0x1p-8f;
// Balls are larger by this, which is more than what rounding makes of angles.
constexpr float kWider = 1 + 1e-5f;

struct Angle {
  float cosine, sine;
};

float sine_of(float cosine) {
  return std::sqrt(std::max(0.0f, 1 - cosine * cosine));
}

// The angle a - b, and 0 where that is below 0; both in [0, pi].
Angle angle_less(const Angle& a, const Angle& b) {
  if (a.cosine >= b.cosine) return {1, 0};
  return {a.cosine * b.cosine + a.sine * b.sine, a.sine * b.cosine - a.cosine * b.sine};
}

float into_unit(float u) {
  return std::clamp(u, 0.0f, 0x1.fffffep-1f);
}

}  // namespace

float LightTree::importance(const Receiver& at, const Node& node) const {
  const Vec3 toward = node.center - at.position;
  const float distance_sq = length_sq(toward);
  const float radius_sq = node.radius_sq * kWider;
  const float least_sq = std::max(std::max(distance_sq, nearest_sq_), radius_sq);
  float brings = node.intensity / least_sq;
  if (distance_sq <= radius_sq) return brings;  // among them, from where they are anywhere
  const Vec3 direction = toward * (1 / std::sqrt(distance_sq));
  // The half angle under which the cluster is seen.
  const float sine_sq = radius_sq / distance_sq;
  const Angle seen{std::sqrt(1 - sine_sq), std::sqrt(sine_sq)};
  if (node.cos_normals > -1) {
    const float cosine = std::clamp(-dot(node.axis, direction), -1.0f, 1.0f);
    const Angle normals{node.cos_normals, sine_of(node.cos_normals)};
    const Angle off = angle_less(angle_less({cosine, sine_of(cosine)}, normals), seen);
    if (off.cosine < node.cos_spread) return 0;
    brings *= std::max(0.0f, off.cosine);
  }
  if (at.normal != Vec3(0, 0, 0)) {
    const float cosine = std::clamp(dot(at.normal, direction), -1.0f, 1.0f);
    brings *= std::max(0.0f, angle_less({cosine, sine_of(cosine)}, seen).cosine);
  }
  return brings;
}

float LightTree::importance(const Receiver& at) const {
  return nodes_.empty() ? 0 : importance(at, nodes_.front());
}

float LightTree::first_share(const Receiver& at, std::uint32_t node) const {
  const float first = importance(at, nodes_[node + 1]);
  const float second = importance(at, nodes_[nodes_[node].second]);
  if (!(first > 0)) return second > 0 ? 0.0f : -1.0f;
  if (!(second > 0)) return 1;
  return std::clamp(first / (first + second), kLeastShare, 1 - kLeastShare);
}

std::size_t LightTree::sample(const Receiver& at, float& u, float& probability,
                              std::uint32_t node) const {
  probability = 0;
  if (node == 0 && !(importance(at) > 0)) return 0;
  float chance = 1;
  while (nodes_[node].second != 0) {
    const float first = first_share(at, node);
    if (first < 0) return 0;
    if (u < first) {
      u = into_unit(u / first);
      chance *= first;
      node = node + 1;
    } else {
      u = into_unit((u - first) / (1 - first));
      chance *= 1 - first;
      node = nodes_[node].second;
    }
  }
  probability = chance;
  return nodes_[node].emitter;
}

float LightTree::probability(const Receiver& at, std::size_t emitter, std::uint32_t node) const {
  std::uint32_t below = leaves_[emitter];
  if (below == kNoLeaf || (node == 0 && !(importance(at) > 0))) return 0;
  std::array<std::uint32_t, kDeepest> way{};
  std::size_t length = 0;
  for (; below != node; below = parents_[below]) way[length++] = below;
  // From above, as sample() multiplies.
  float chance = 1;
  while (length > 0) {
    const float first = first_share(at, node);
    if (first < 0) return 0;
    const std::uint32_t child = way[--length];
    chance *= child == node + 1 ? first : 1 - first;
    node = child;
  }
  return chance;
}

float LightTree::most(const Receiver& at, const Cluster& cluster) const {
  constexpr float kWithin = 0.25f;  // of its radius: as near as it counts
  const Node& node = nodes_[cluster.node];
  const float radius = std::sqrt(node.radius_sq);
  const float gap = std::sqrt(length_sq(node.center - at.position)) - radius;
  const float nearest = std::max(gap, kWithin * radius);
  return node.intensity / std::max(nearest * nearest, nearest_sq_);
}

LightTree::Cut LightTree::cut(const Receiver& at) const {
  // A cluster that may bring less than this share of all is left whole.
  constexpr float kLeftWhole = 0x1p-6f;
  Cut cut;
  cut.importance = importance(at);
  if (!(cut.importance > 0)) return cut;
  std::array<float, 32> most_of{};
  const auto set = [&](std::size_t k, const Cluster& cluster) {
    cut.clusters[k] = cluster;
    most_of[k] = is_single(cluster) ? 0 : most(at, cluster);
  };
  set(cut.count++, {0, cut.importance});
  while (cut.count < cut.clusters.size()) {
    const auto begin = most_of.begin();
    const auto largest = std::max_element(begin, begin + static_cast<std::ptrdiff_t>(cut.count));
    if (!(*largest > kLeftWhole * cut.importance)) break;
    const auto k = static_cast<std::size_t>(largest - begin);
    const std::uint32_t node = cut.clusters[k].node;
    const Cluster first{node + 1, importance(at, nodes_[node + 1])};
    const std::uint32_t number = nodes_[node].second;
    const Cluster second{number, importance(at, nodes_[number])};
    cut.importance += first.importance + second.importance - cut.clusters[k].importance;
    if (first.importance > 0 && second.importance > 0) {
      set(k, first);
      set(cut.count++, second);
    } else if (first.importance > 0 || second.importance > 0) {
      set(k, first.importance > 0 ? first : second);
    } else {
      --cut.count;
      cut.clusters[k] = cut.clusters[cut.count];
      most_of[k] = most_of[cut.count];
      if (cut.count == 0) break;
    }
  }
  cut.importance = 0;
  for (std::size_t k = 0; k < cut.count; ++k) cut.importance += cut.clusters[k].importance;
  return cut;
}

std::size_t LightTree::holder(const Cut& cut, std::size_t emitter) const {
  if (emitter >= leaves_.size() || leaves_[emitter] == kNoLeaf) return cut.count;
  for (std::uint32_t node = leaves_[emitter];; node = parents_[node]) {
    for (std::size_t k = 0; k < cut.count; ++k) {
      if (cut.clusters[k].node == node) return k;
    }
    if (node == 0) return cut.count;
  }
}

}  // namespace psf::render
