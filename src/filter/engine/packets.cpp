#include "filter/engine/packets.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "search/compact_order.h"

namespace psf::filter::engine {
namespace {

std::vector<search::Box> boxes_of(const Tree& tree) {
  std::vector<search::Box> boxes;
  for (std::size_t k = 0; k < tree.nodes(kParents); ++k) boxes.push_back(tree.box(kParents, k));
  return boxes;
}

std::vector<std::uint32_t> sources_of(const Problem& problem,
                                      const std::vector<std::uint32_t>& queries) {
  std::vector<std::uint32_t> sources;
  if (problem.sources_apart) {
    return search::compact_order(problem.records.position, problem.roles.sources);
  }
  if (problem.roles.sources.size() == queries.size()) return queries;
  sources.reserve(problem.roles.sources.size());
  std::copy_if(queries.begin(), queries.end(), std::back_inserter(sources),
               [&](std::uint32_t i) { return problem.roles.of[i] == Role::source; });
  return sources;
}

// Products and sums of products of values up to this are finite floats, which the bounds rely on.
constexpr float kLargest = 1e18f;

bool is_moderate_vector(const Vec3& v) {
  return std::max(std::max(std::abs(v.x), std::abs(v.y)), std::abs(v.z)) <= kLargest;
}

}  // namespace

Packets::Packets(const Problem& problem)
    : p_(problem),
      order_(search::compact_order(problem.records.position, problem.roles.queries)),
      tree_(problem.records, sources_of(problem, order_), ColumnPlan(problem.weights.terms())),
      all_sources_(!problem.sources_apart && order_.size() == tree_.size()),
      index_(is_moderate() ? boxes_of(tree_) : std::vector<search::Box>()) {}

bool Packets::is_moderate() const {
  if (!tree_.all_within(kLargest)) return false;
  if (all_sources_) return true;
  const Records& r = p_.records;
  const ColumnPlan& plan = tree_.plan();
  return std::all_of(order_.begin(), order_.end(), [&](std::uint32_t i) {
    return is_moderate_vector(r.position[i]) && (!plan.normal || is_moderate_vector(r.normal[i])) &&
           (!plan.reflectance || is_moderate_vector(r.reflectance[i])) &&
           (!plan.direction || is_moderate_vector(r.direction[i]));
  });
}

void Packets::search_for(std::size_t begin, std::span<const std::uint32_t> queries,
                         std::vector<std::uint32_t>& nodes) const {
  float r = 0;
  for (const std::uint32_t i : queries) r = std::max(r, p_.radius[i]);
  index_.within(all_sources_ ? tree_.box(kParents, begin / kGrain) : box_of(queries), r * r, nodes);
}

search::Box Packets::box_of(std::span<const std::uint32_t> queries) const {
  search::Box box{p_.records.position[queries[0]], p_.records.position[queries[0]]};
  for (const std::uint32_t i : queries) {
    const Vec3& x = p_.records.position[i];
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], x[axis]);
      box.high[axis] = std::max(box.high[axis], x[axis]);
    }
  }
  return box;
}

void Packets::fill(std::span<const std::uint32_t> queries, std::size_t number, Own& own,
                   Packet& packet) const {
  const ColumnPlan& plan = tree_.plan();
  if (all_sources_) {
    packet.columns = tree_.group(number);
    packet.low = tree_.bounds(kGroups, number / kWidth) + number % kWidth;
    packet.high = packet.low + plan.count * kWidth;
  } else {
    plan.gather(p_.records, queries, own.columns);
    extremes(plan, plan.count, own.columns, own.columns, own.low, own.high);
    packet.columns = own.columns;
    packet.low = own.low;
    packet.high = own.high;
  }
  const float plane = p_.weights.terms().plane.value_or(0);
  for (std::size_t k = 0; k < kWidth; ++k) {
    const float r_i = p_.radius[queries[std::min(k, queries.size() - 1)]];
    packet.r_sq[k] = k < queries.size() ? r_i * r_i : 0;
    const float reach = plane * r_i;
    packet.plane_reach[k] = std::isnan(reach) ? -1 : reach;  // 0 times infinity: nothing passes
    packet.count[k] = 0;
    for (auto& sum : packet.sum) sum[k] = 0;
  }
}

}  // namespace psf::filter::engine
