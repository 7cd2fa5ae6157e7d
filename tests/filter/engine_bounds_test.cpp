// What bounds decide for whole nodes is what every pair below says, also where a threshold lies
// exactly on a value that occurs.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "catch.h"
#include "engine_case.h"
#include "filter/engine/instruction_sets.h"
#include "filter/engine/kernel.h"

namespace psf {
namespace {

using filter::engine::kWidth;
using filter::engine::PairCounts;

constexpr unsigned kTermBits = 8;

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  std::uint32_t below(std::size_t n) { return static_cast<std::uint32_t>(engine_() % n); }
  bool one_in(std::size_t n) { return below(n) == 0; }
  // A multiple of 1/8, so that there are many ties, or any number.
  float value() {
    return one_in(2) ? static_cast<float>(below(9)) / 8 - 0.5f
                     : std::uniform_real_distribution<float>(-0.5f, 0.5f)(engine_);
  }
  Vec3 vector() {
    const float x = value(), y = value();
    return {x, y, value()};
  }

 private:
  std::mt19937 engine_;
};

// Copies what the filter looks at from record `from` to record `to`.
void copy_record(tests::RecordSet& set, std::size_t from, std::size_t to) {
  set.position[to] = set.position[from];
  set.normal[to] = set.normal[from];
  set.reflectance[to] = set.reflectance[from];
  set.visibility[to] = set.visibility[from];
  set.hit_distance[to] = set.hit_distance[from];
  set.direction[to] = set.direction[from];
  set.material[to] = set.material[from];
  set.roughness[to] = set.roughness[from];
}

// Moves one value of a record.
void vary_record(tests::RecordSet& set, std::size_t i, std::uint32_t what, Random& random) {
  const int axis = static_cast<int>(random.below(3));
  if (what == 0) set.position[i][axis] = random.value();
  if (what == 1) set.normal[i][axis] = random.value();
  if (what == 2) set.reflectance[i][axis] = random.value();
  if (what == 3) set.visibility[i] = random.below(3) << 30;
  if (what == 4) set.hit_distance[i] = random.one_in(4) ? tests::kInfinity : random.value() + 0.5f;
  if (what == 5) set.direction[i][axis] = random.value();
  if (what == 6) set.material[i] = random.below(3) << 30;
  if (what == 7) set.roughness[i] = random.one_in(4) ? 1 : random.value() + 0.5f;
}

// Groups of records that are equal, equal but for one value, or all different; the first group are
// the queries.
tests::RecordSet random_groups(std::size_t count, Random& random) {
  tests::RecordSet set(count);
  for (std::size_t first = 0; first < count; first += kWidth) {
    const std::uint32_t kind = random.below(4), what = random.below(kTermBits);
    for (std::size_t i = first; i < std::min(count, first + kWidth); ++i) {
      if (first > 0 && random.one_in(2)) {
        copy_record(set, i - kWidth, i);
      } else {
        for (std::uint32_t k = 0; k < kTermBits; ++k) vary_record(set, i, k, random);
        set.position[i] = random.vector() * 2.0f;
        set.normal[i] = random.vector();
        set.direction[i] = random.vector();
      }
      if (kind < 3 && i > first) copy_record(set, first, i);
      if (kind == 1 || kind == 2) vary_record(set, i, kind == 1 ? what : 0, random);
    }
  }
  return set;
}

// A packet of the first records against all records, with thresholds on pairs that there are.
struct Scene {
  tests::RecordSet set;
  filter::WeightTerms terms = filter::WeightTerms::none();
  std::vector<Rgb> values;
  alignas(64) float r_sq[kWidth], reach[kWidth];
  std::size_t queries;

  explicit Scene(Random& random)
      : set(random_groups(1 + random.below(700), random)),
        values(set.size()),
        queries(std::min(set.size(), kWidth)) {
    for (std::size_t j = 0; j < set.size(); ++j) {
      const auto number = static_cast<std::uint32_t>(j + 1);
      values[j] =
          Rgb(static_cast<float>(number), static_cast<float>(number * 2654435761u >> 20), 1);
    }
    const auto pick = [&] { return std::size_t{random.below(set.size())}; };
    const std::uint32_t by = random.one_in(3) ? 0 : random.below(256) & random.below(256);
    const std::size_t i = pick() % queries, j = pick();
    if ((by & 1) != 0) terms.normal = dot(set.normal[i], set.normal[j]);
    if ((by & 2) != 0) {
      const float d_sq = search::distance_sq(set.reflectance[i], set.reflectance[j]);
      terms.reflectance = std::sqrt(d_sq);
    }
    terms.visibility = (by & 4) != 0;
    if ((by & 8) != 0) {
      const float a = set.hit_distance[i], b = set.hit_distance[j];
      terms.hit_distance = std::isfinite(a + b) ? std::abs(a - b) / std::max(a, b) : 0.5f;
      if (!(*terms.hit_distance >= 0)) terms.hit_distance = 0;
    }
    if ((by & 16) != 0) terms.plane = 1;
    if ((by & 32) != 0) terms.direction = dot(set.direction[i], set.direction[j]);
    terms.material = (by & 64) != 0;
    if ((by & 128) != 0) terms.gloss = threshold_between(i, j);
    const bool common = random.one_in(2);
    for (std::size_t k = 0; k < kWidth; ++k) {
      const std::size_t query = common ? i : k, other = common ? j : pick();
      const Vec3 x = set.position[query % queries], y = set.position[other];
      r_sq[k] = search::distance_sq(y, x);
      if (!common && random.one_in(3)) r_sq[k] = std::nextafter(r_sq[k], tests::kInfinity);
      if (random.one_in(20)) r_sq[k] = tests::kInfinity;
      if (k >= queries) r_sq[k] = 0;
      reach[k] = std::abs(dot(Vec3(y.x - x.x, y.y - x.y, y.z - x.z), set.normal[query % queries]));
      if (random.one_in(50)) reach[k] = -1;  // nothing passes
    }
    if (by != 0 && random.one_in(2)) std::fill(r_sq, r_sq + queries, 1e3f);
  }

 private:
  // At which `gloss` passes the pair, but for the last bits.
  [[nodiscard]] float threshold_between(std::size_t i, std::size_t j) const {
    const float turned = std::sqrt(search::distance_sq(set.normal[i], set.normal[j]) +
                                   100 * search::distance_sq(set.direction[i], set.direction[j]));
    const float t = turned / (set.roughness[i] * set.roughness[i]);
    return t > 0 && std::isfinite(t) ? t : 1;
  }
};

// By the definitions, one pair at a time. Returns how many records differ.
std::size_t differing(const Scene& scene, const filter::engine::Packet& packet,
                      const PairCounts& counts) {
  const filter::Records records = scene.set.view();
  filter::WeightTerms but_plane = scene.terms;
  but_plane.plane.reset();
  const filter::Weights weights(records, but_plane);
  std::size_t wrong = 0;
  PairCounts expected;
  for (std::uint32_t i = 0; i < scene.queries; ++i) {
    double sum[3] = {};
    std::int32_t count = 0;
    for (std::uint32_t j = 0; j < records.size(); ++j) {
      const float d_sq = search::distance_sq(records.position[i], records.position[j]);
      if (!search::chi_ball(d_sq, scene.r_sq[i])) continue;
      std::uint32_t refusers = weights.refusers(i, j, 0);
      if (scene.terms.plane && !filter::plane_term(records.position[i], records.normal[i],
                                                   records.position[j], 1, scene.reach[i])) {
        refusers |= 16;
      }
      ++expected.candidates;
      for (unsigned k = 0; k < kTermBits; ++k) expected.refused[k] += refusers >> k & 1;
      if (refusers != 0) continue;
      for (int c = 0; c < 3; ++c) sum[c] += double{scene.values[j][c]};
      ++count;
    }
    const bool same = packet.count[i] == count && packet.sum[0][i] == sum[0] &&
                      packet.sum[1][i] == sum[1] && packet.sum[2][i] == sum[2];
    wrong += same ? 0u : 1u;
  }
  wrong += counts.candidates == expected.candidates && counts.refused == expected.refused ? 0u : 1u;
  return wrong;
}

std::size_t differing(const Scene& scene) {
  std::vector<std::uint32_t> order(scene.set.size());
  std::iota(order.begin(), order.end(), 0u);
  const filter::engine::Tree tree(scene.set.view(), order, filter::engine::ColumnPlan(scene.terms));
  const filter::engine::TreeSums sums(tree, scene.values, {});
  const std::size_t columns = tree.plan().count;
  alignas(64) float low[filter::engine::kMaxColumns * kWidth] = {};
  alignas(64) float high[filter::engine::kMaxColumns * kWidth] = {};
  filter::engine::extremes(tree.plan(), columns, tree.group(0), tree.group(0), low, high);
  filter::engine::Packet packet{};
  packet.columns = tree.group(0);
  packet.low = low;
  packet.high = high;
  std::copy(scene.r_sq, scene.r_sq + kWidth, packet.r_sq);
  std::copy(scene.reach, scene.reach + kWidth, packet.plane_reach);
  std::vector<std::uint32_t> parents(tree.nodes(filter::engine::kParents));
  std::iota(parents.begin(), parents.end(), 0u);
  filter::engine::add_sources(tree, sums, scene.terms, parents, packet);
  // In two steps it is the same to the last bit, for each of five values.
  filter::engine::Packet again = packet;
  filter::engine::Found found;
  filter::engine::find_sources(tree, scene.terms, parents, again, found);
  constexpr std::size_t kValues = 5;
  std::vector<filter::engine::TreeSums> five;
  for (std::size_t v = 0; v < kValues; ++v) {
    std::vector<Rgb> values = scene.values;
    for (Rgb& value : values) value *= static_cast<float>(v + 1);
    five.emplace_back(tree, values, std::span<const float>());
  }
  alignas(64) double out[kValues][3][kWidth];
  filter::engine::add_found(five, found, out[0][0]);
  std::size_t in_two_steps = 0;
  for (std::size_t v = 0; v < kValues; ++v) {
    filter::engine::Packet alone = packet;
    for (auto& sum : alone.sum) std::fill_n(sum, kWidth, 0.0);
    std::fill_n(alone.count, kWidth, 0);
    filter::engine::add_sources(tree, five[v], scene.terms, parents, alone);
    const bool same = std::memcmp(alone.sum, out[v], sizeof out[v]) == 0 &&
                      std::memcmp(alone.count, again.count, sizeof again.count) == 0 &&
                      std::memcmp(alone.met_itself, again.met_itself, sizeof again.met_itself) == 0;
    in_two_steps += same ? 0 : 1;
  }
  PairCounts counts;
  filter::engine::count_pairs(tree, scene.terms, parents, packet, counts);
  return differing(scene, packet, counts) + in_two_steps;
}

void check_bounds(std::uint32_t scenes, std::uint32_t seed) {
  const std::vector<std::string> sets = filter::engine::instruction_sets();
  for (const std::string& set : sets) {
    const filter::engine::InstructionSetLimit limit(set);
    Random random(seed);
    std::size_t wrong = 0;
    for (std::uint32_t k = 0; k < scenes; ++k) wrong += differing(Scene(random)) == 0 ? 0u : 1u;
    INFO(set);
    CHECK(wrong == 0);
  }
}

TEST_CASE("Bounds never contradict a pair") {
  check_bounds(1500, 1);
}

TEST_CASE("Bounds never contradict a pair, many packets", "[.][long]") {
  check_bounds(20'000, 2);
}

}  // namespace
}  // namespace psf
