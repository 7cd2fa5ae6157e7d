// A hierarchy of many emitters, from which one is chosen by what it may bring to a place: power,
// distance and orientation of whole clusters (Conty Estevez and Kulla 2018, "Importance Sampling of
// Many Lights with Adaptive Tree Splitting").
#pragma once

#include <ImathBox.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/vec.h"

namespace psf::render {

// Where light is asked for.
struct Receiver {
  Vec3 position;
  Vec3 normal{0, 0, 0};  // unit: light from behind does nothing; 0: light may come from anywhere
};

// What is known of where an emitter shines.
struct LightBounds {
  Imath::Box3f box;
  Vec3 axis{0, 0, 1};      // unit
  float cos_normals = -1;  // of the largest angle between axis and the normals of the emitter
  float cos_spread = -1;   // of the largest angle between a normal and light that leaves there
  float intensity = 0;     // radiant intensity where it is brightest, in any unit
};

// Of both; what has intensity 0 does not count.
[[nodiscard]] LightBounds join(const LightBounds& a, const LightBounds& b);

// The emitters are numbered as they are given. Those of intensity 0 are never chosen.
class LightTree {
 public:
  LightTree() = default;
  // `nearest`: closer than this to a receiver an emitter brings no more; above 0.
  LightTree(std::span<const LightBounds> emitters, float nearest);

  [[nodiscard]] bool empty() const { return nodes_.empty(); }
  // About the irradiance that all of it may bring, in the unit of the intensities; 0 only where
  // none of it can arrive.
  [[nodiscard]] float importance(const Receiver& at) const;
  // Chooses an emitter below `node`, the root being 0. `u` is replaced by its place in the part of
  // [0, 1) that stands for it. Where `probability` is 0 no light arrives, and the result has no
  // meaning.
  [[nodiscard]] std::size_t sample(const Receiver& at, float& u, float& probability,
                                   std::uint32_t node = 0) const;
  // The probability with which sample() chooses it below a node that it is below.
  [[nodiscard]] float probability(const Receiver& at, std::size_t emitter,
                                  std::uint32_t node = 0) const;

  struct Cluster {
    std::uint32_t node;
    float importance;
  };
  // Clusters that do not overlap and hold all emitters whose light may arrive.
  struct Cut {
    std::array<Cluster, 32> clusters{};
    std::size_t count = 0;
    float importance = 0;  // of all together
  };
  // Those that are near or bring much are cut first, until single emitters are left or the clusters
  // are as many as there is room for.
  [[nodiscard]] Cut cut(const Receiver& at) const;
  [[nodiscard]] bool is_single(const Cluster& cluster) const {
    return nodes_[cluster.node].second == 0;
  }
  // Of a single one.
  [[nodiscard]] std::size_t emitter(const Cluster& cluster) const {
    return nodes_[cluster.node].emitter;
  }
  // The number of the cluster that holds an emitter; count where none does.
  [[nodiscard]] std::size_t holder(const Cut& cut, std::size_t emitter) const;

 private:
  static constexpr std::size_t kDeepest = 64;
  static constexpr std::uint32_t kNoLeaf = std::numeric_limits<std::uint32_t>::max();
  struct Node {
    Vec3 center{0, 0, 0};  // of a ball around it
    float radius_sq = 0;
    Vec3 axis{0, 0, 1};
    float cos_normals = -1, cos_spread = -1, intensity = 0;
    std::uint32_t second = 0;  // its second child, the first follows it; 0: a leaf
    std::uint32_t emitter = 0;
  };
  struct Builder;

  [[nodiscard]] float importance(const Receiver& at, const Node& node) const;
  // About the most that it may bring, if it stood where it is nearest.
  [[nodiscard]] float most(const Receiver& at, const Cluster& cluster) const;
  // The probability of the first child of a node; below 0 where no light comes from either.
  [[nodiscard]] float first_share(const Receiver& at, std::uint32_t node) const;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> parents_;  // by node
  std::vector<std::uint32_t> leaves_;   // by emitter; kNoLeaf: it is never chosen
  float nearest_sq_ = 0;
};

}  // namespace psf::render
