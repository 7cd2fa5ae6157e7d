// A hierarchy of many emitters: how it is cut into clusters, by the surface area orientation
// heuristic of Conty Estevez and Kulla.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "render/light/frame.h"
#include "render/light/light_tree.h"

namespace psf::render {
namespace {

// Below this many cuts by the heuristic clusters are halved, so that no way is longer than kDeepest.
constexpr std::size_t kFreeCuts = 32;
constexpr std::size_t kBins = 12;

float cone_angle(float cosine) {
  return std::acos(std::clamp(cosine, -1.0f, 1.0f));
}

// Sets axis and cosine of a cone around two.
void join_cones(const LightBounds& a, const LightBounds& b, LightBounds& sum) {
  sum.axis = a.axis;
  sum.cos_normals = -1;
  if (a.cos_normals <= -1 || b.cos_normals <= -1) return;
  const float angle_a = cone_angle(a.cos_normals), angle_b = cone_angle(b.cos_normals);
  const Vec3 across = b.axis - a.axis * dot(a.axis, b.axis);
  const float sine = std::sqrt(length_sq(across));
  const float between = std::atan2(sine, dot(a.axis, b.axis));
  if (between + angle_b <= angle_a) {
    sum.cos_normals = a.cos_normals;
    return;
  }
  if (between + angle_a <= angle_b) {
    sum.axis = b.axis;
    sum.cos_normals = b.cos_normals;
    return;
  }
  const float half = 0.5f * (angle_a + between + angle_b);
  // Axes that are opposite to each other have no direction between them.
  if (half >= kPi || !(sine > 1e-6f)) return;
  const float turn = half - angle_a;
  sum.axis = normalize(a.axis * std::cos(turn) + across * (std::sin(turn) / sine));
  // A little wider than it need be, for what rounding does to angles.
  sum.cos_normals = std::max(-1.0f, std::cos(half) - 3e-5f);
}

}  // namespace

LightBounds join(const LightBounds& a, const LightBounds& b) {
  if (!(a.intensity > 0)) return b;
  if (!(b.intensity > 0)) return a;
  LightBounds sum;
  sum.box = a.box;
  sum.box.extendBy(b.box);
  sum.intensity = a.intensity + b.intensity;
  sum.cos_spread = std::min(a.cos_spread, b.cos_spread);
  join_cones(a, b, sum);
  return sum;
}

namespace {

// What it costs to have a cluster: the more, the larger, the further spread, and the brighter it is.
double cost(const LightBounds& cluster) {
  const double normals = double{cone_angle(cluster.cos_normals)};
  const double widest =
      std::min(normals + double{cone_angle(cluster.cos_spread)}, std::numbers::pi);
  const double wide = 2 * widest - 2 * normals;
  // The solid angle of the cone, with what is beyond it less by the cosine.
  const double orientation =
      2 * std::numbers::pi * (1 - std::cos(normals)) +
      std::numbers::pi / 2 *
          (wide * std::sin(normals) - std::cos(normals - 2 * widest) + std::cos(normals));
  // Not the area of the box, which would be 0 for lamps in a row.
  return double{cluster.intensity} * orientation * double{length_sq(cluster.box.size())};
}

}  // namespace

struct LightTree::Builder {
  std::span<const LightBounds> emitters;
  LightTree& tree;

  // Adds the cluster of some emitters, which it puts in order, and returns its number.
  std::uint32_t add(std::span<std::uint32_t> members, std::size_t depth) {
    const auto number = static_cast<std::uint32_t>(tree.nodes_.size());
    tree.nodes_.emplace_back();
    tree.parents_.push_back(0);
    LightBounds whole;
    for (const std::uint32_t m : members) whole = join(whole, emitters[m]);
    describe(whole, tree.nodes_[number]);
    if (members.size() == 1) {
      tree.nodes_[number].emitter = members.front();
      tree.leaves_[members.front()] = number;
      return number;
    }
    const std::size_t half = cut(members, whole, depth);
    const std::uint32_t first = add(members.first(half), depth + 1);
    const std::uint32_t second = add(members.subspan(half), depth + 1);
    tree.nodes_[number].second = second;
    tree.parents_[first] = tree.parents_[second] = number;
    return number;
  }

  static void describe(const LightBounds& whole, Node& node) {
    node.center = whole.box.center();
    node.radius_sq = 0.25f * length_sq(whole.box.size());
    node.axis = whole.axis;
    node.cos_normals = whole.cos_normals;
    node.cos_spread = whole.cos_spread;
    node.intensity = whole.intensity;
  }

  [[nodiscard]] float middle(std::uint32_t member, int axis) const {
    const Imath::Box3f& box = emitters[member].box;
    return 0.5f * (box.min[axis] + box.max[axis]);
  }

  // Puts the members in two groups and returns how many are in the first.
  std::size_t cut(std::span<std::uint32_t> members, const LightBounds& whole, std::size_t depth) {
    Imath::Box3f middles;
    for (const std::uint32_t m : members) middles.extendBy(emitters[m].box.center());
    int best_axis = -1;
    std::size_t best_bin = 0;
    double least = std::numeric_limits<double>::infinity();
    if (depth < kFreeCuts) {
      for (int axis = 0; axis < 3; ++axis) {
        if (!(middles.size()[axis] > 0)) continue;
        const auto [bin, price] = best_cut(members, middles, whole, axis);
        if (!(price < least)) continue;
        least = price;
        best_axis = axis;
        best_bin = bin;
      }
    }
    if (best_axis >= 0) {
      const auto end = std::partition(members.begin(), members.end(), [&](std::uint32_t m) {
        return bin_of(m, middles, best_axis) <= best_bin;
      });
      const auto half = static_cast<std::size_t>(end - members.begin());
      if (half > 0 && half < members.size()) return half;
    }
    const auto axis = static_cast<int>(middles.majorAxis());
    std::sort(members.begin(), members.end(), [&](std::uint32_t a, std::uint32_t b) {
      const float at_a = middle(a, axis), at_b = middle(b, axis);
      return at_a != at_b ? at_a < at_b : a < b;
    });
    return members.size() / 2;
  }

  [[nodiscard]] std::size_t bin_of(std::uint32_t member, const Imath::Box3f& middles,
                                   int axis) const {
    const float share = (middle(member, axis) - middles.min[axis]) / middles.size()[axis];
    return std::min(static_cast<std::size_t>(std::max(0.0f, share) * kBins), kBins - 1);
  }

  // The last bin of the first group, and the cost of both, where it is best to cut along an axis.
  [[nodiscard]] std::pair<std::size_t, double> best_cut(std::span<const std::uint32_t> members,
                                                        const Imath::Box3f& middles,
                                                        const LightBounds& whole, int axis) const {
    std::array<LightBounds, kBins> bins{};
    for (const std::uint32_t m : members) {
      LightBounds& bin = bins[bin_of(m, middles, axis)];
      bin = join(bin, emitters[m]);
    }
    std::array<double, kBins> behind{};
    LightBounds sum;
    for (std::size_t k = kBins - 1; k > 0; --k) {
      sum = join(sum, bins[k]);
      behind[k] = sum.intensity > 0 ? cost(sum) : std::numeric_limits<double>::infinity();
    }
    sum = {};
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k + 1 < kBins; ++k) {
      sum = join(sum, bins[k]);
      if (!(sum.intensity > 0)) continue;
      const double price = cost(sum) + behind[k + 1];
      if (!(price < least)) continue;
      least = price;
      best = k;
    }
    // Thin clusters are worse than their area says.
    const float longest = whole.box.size()[static_cast<int>(whole.box.majorAxis())];
    return {best, least * double{longest / std::max(whole.box.size()[axis], 1e-6f * longest)}};
  }
};

LightTree::LightTree(std::span<const LightBounds> emitters, float nearest)
    : leaves_(emitters.size(), kNoLeaf), nearest_sq_(nearest * nearest) {
  std::vector<std::uint32_t> members;
  for (std::size_t e = 0; e < emitters.size(); ++e) {
    if (emitters[e].intensity > 0) members.push_back(static_cast<std::uint32_t>(e));
  }
  if (members.empty()) return;
  nodes_.reserve(2 * members.size() - 1);
  parents_.reserve(nodes_.capacity());
  Builder{emitters, *this}.add(members, 0);
}

}  // namespace psf::render
