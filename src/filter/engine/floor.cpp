#include "filter/engine/floor.h"

#include <numeric>
#include <random>
#include <vector>

#include "filter/engine/kernel.h"
#include "filter/engine/tree.h"

namespace psf::filter::engine {
namespace {

constexpr std::size_t kSources = kWidth * kWidth;  // the groups of one parent
static_assert(Floor::kPairs == kWidth * kSources);
// Reaches over part of a unit cube from anywhere in it, over all of it from nowhere.
constexpr float kRadius = 0.6f;

// Each value at random, so that the sources of every node, in any order, are strewn over all there
// are.
struct Strewn {
  std::vector<Vec3> position, normal, direction;
  std::vector<Rgb> reflectance, value;
  std::vector<std::uint32_t> bits;
  std::vector<float> hit_distance, roughness;

  Strewn() {
    std::mt19937 random(1);
    const auto unit = [&random] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
    const auto point = [&unit] {
      const float x = unit(), y = unit();
      return Vec3(x, y, unit());
    };
    const auto axis = [&random] {
      Vec3 v(0, 0, 0);
      v[static_cast<int>(random() % 3)] = 1;
      return v;
    };
    for (std::size_t j = 0; j < kSources; ++j) {
      position.push_back(point());
      normal.push_back(axis());
      direction.push_back(axis());
      const Vec3 color = point();
      reflectance.emplace_back(color.x, color.y, color.z);
      value.emplace_back(unit());
      bits.push_back(static_cast<std::uint32_t>(random() % 2));
      hit_distance.push_back(0.1f + unit());
      roughness.push_back(unit());
    }
  }

  [[nodiscard]] Records view() const {
    Records records;
    records.position = position;
    records.normal = normal;
    records.direction = direction;
    records.reflectance = reflectance;
    records.visibility = records.material = bits;
    records.hit_distance = hit_distance;
    records.roughness = roughness;
    return records;
  }
};

std::vector<std::uint32_t> in_order() {
  std::vector<std::uint32_t> order(kSources);
  std::iota(order.begin(), order.end(), 0u);
  return order;
}

}  // namespace

struct Floor::State {
  explicit State(const WeightTerms& on)
      : terms(on), tree(records.view(), in_order(), ColumnPlan(on)), sums(tree, records.value, {}) {
    // The queries are the sources of the first group.
    extremes(tree.plan(), tree.plan().count, tree.group(0), tree.group(0), low, high);
    packet.columns = tree.group(0);
    packet.low = low;
    packet.high = high;
    for (std::size_t k = 0; k < kWidth; ++k) {
      packet.r_sq[k] = kRadius * kRadius;
      packet.plane_reach[k] = terms.plane.value_or(0) * kRadius;
    }
  }

  WeightTerms terms;
  Strewn records;
  Tree tree;
  TreeSums sums;
  alignas(64) float low[kMaxColumns * kWidth] = {};  // every kWidth-th counts
  alignas(64) float high[kMaxColumns * kWidth] = {};
  Packet packet;
};

Floor::Floor(const WeightTerms& terms) : state_(std::make_unique<State>(terms)) {}
Floor::~Floor() = default;

std::uint64_t Floor::run(std::size_t times) {
  Packet& packet = state_->packet;
  std::uint64_t passed = 0;
  for (std::size_t time = 0; time < times; ++time) {
    for (auto& sum : packet.sum) std::fill(sum, sum + kWidth, 0.0);
    std::fill(packet.count, packet.count + kWidth, 0);
    constexpr std::uint32_t kParent = 0;
    add_sources(state_->tree, state_->sums, state_->terms, {&kParent, 1}, packet);
    passed += static_cast<std::uint64_t>(std::accumulate(packet.count, packet.count + kWidth, 0));
  }
  return passed;
}

}  // namespace psf::filter::engine
