#include "explain/block.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "explain/pairs.h"
#include "explain/path_fit.h"
#include "filter/estimators/disk.h"
#include "filter/inputs.h"
#include "filter/radius.h"
#include "search/ball.h"

namespace psf::explain {
namespace {

void take_room(std::size_t pairs, std::atomic<std::int64_t>& room) {
  if ((room -= static_cast<std::int64_t>(pairs)) >= 0) return;
  throw Error(ErrorCode::limit,
              "the balls around this pixel's vertices hold too many sources to list; choose a "
              "smaller `r0` or `block`, fewer `passes`, or one `path`");
}

}  // namespace

BlockExplainer::BlockExplainer(const filter::Records& records, const filter::Block& block,
                               const filter::Parameters& parameters)
    : parameters_(parameters) {
  std::vector<float> given;
  filter::radii(parameters.radius, records, block, given);
  estimates_ = filter::estimate(records, given, block, parameters, &fireflies_);
  for (const filter::Fireflies& some : fireflies_) {
    every_firefly_.insert(every_firefly_.end(), some.all().begin(), some.all().end());
  }
  std::sort(every_firefly_.begin(), every_firefly_.end(),
            [](const auto& a, const auto& b) { return a.record < b.record; });
  if (parameters.iterations > 1) {
    filter::Parameters fewer = parameters;
    --fewer.iterations;
    filter::Estimates before = filter::estimate(records, given, block, fewer);
    for (std::size_t i = 0; i < before.given.size(); ++i) before.c_bar[i] -= before.given[i];
    before_ = std::move(before.c_bar);
  }
  radius_in_world_ = estimates_.radius.empty() ? given : estimates_.radius;
  scaled_.emplace(records, radius_in_world_);
  records_ = scaled_->records();
  radius_ = scaled_->radius();
  weights_.emplace(records_, parameters.weights);
  add_kin(false);
  if (filter::has_kinds_apart(records_)) add_kin(true);
  if (filter::info(parameters.estimator).is_over_area) {
    area_ = filter::disk_areas(records_, kin_[0].roles, block);
  }
}

void BlockExplainer::add_kin(bool in_volumes) {
  Kin kin;
  kin.roles.of = estimates_.roles;
  std::vector<Vec3> positions;
  for (std::uint32_t j = 0; j < records_.size(); ++j) {
    if (!is_source(j) || records_.in_volume(j) != in_volumes) continue;
    kin.roles.sources.push_back(j);
    positions.push_back(records_.position[j]);
  }
  kin.search = search::make_search(search::Kind::brute, positions);
  kin_.push_back(std::move(kin));
}

ExplainedPath BlockExplainer::explain(std::uint32_t i, std::vector<ExplainedPair>& pairs,
                                      std::atomic<std::int64_t>& room) const {
  ExplainedPath path;
  path.vertex = i;
  path.fate = fate_of(i);
  path.is_input = filter::is_input(estimates_.roles[i]);
  if (path.fate == PathFate::no_vertex || path.fate == PathFate::left_out) return path;
  path.radius = radius_in_world_[i];
  path.c_bar = estimates_.c_bar[i];
  path.neighbors = estimates_.neighbors[i];
  find_pairs(i, pairs, room);
  path.in_ball = static_cast<std::uint32_t>(pairs.size());
  if (path.neighbors == 0) adopt(i, pairs);
  if (!estimates_.given.empty()) path.given = estimates_.given[i];
  find_givers(i, pairs, room);
  std::sort(pairs.begin(), pairs.end(),
            [](const auto& a, const auto& b) { return a.vertex < b.vertex; });
  path.scale = scale_of(i, pairs);
  fit(path, pairs);
  return path;
}

Rgb BlockExplainer::value(std::uint32_t j) const {
  const Rgb& c = parameters_.iterations > 1 ? before_[j] : records_.contribution[j];
  const bool demodulated = parameters_.demodulate && is_source(j);
  const Rgb value = demodulated ? filter::demodulate(c, records_.reflectance[j]) : c;
  const auto of = parameters_.iterations == 1 ? firefly(j) : std::nullopt;
  return of ? value * of->kept : value;
}

std::optional<ExplainedFirefly> BlockExplainer::firefly(std::uint32_t j) const {
  const auto at = std::lower_bound(
      every_firefly_.begin(), every_firefly_.end(), j,
      [](const filter::Firefly& firefly, std::uint32_t record) { return firefly.record < record; });
  if (at == every_firefly_.end() || at->record != j) return std::nullopt;
  const auto sources =
      at->per_source > 0 ? static_cast<std::uint64_t>(std::llround(1 / at->per_source)) : 0;
  return ExplainedFirefly{j, at->luminance, at->ordinary, at->kept, at->reach, sources};
}

// Without area a ball holds its own value; in volumes a disk is none.
bool BlockExplainer::is_disk(std::uint32_t i) const {
  return filter::info(parameters_.estimator).is_over_area && radius_[i] * radius_[i] > 0 &&
         !records_.in_volume(i);
}

PathFate BlockExplainer::fate_of(std::uint32_t i) const {
  const filter::Role role = estimates_.roles[i];
  if (role == filter::Role::left_out) return PathFate::left_out;
  if (!filter::is_query(role)) return PathFate::no_vertex;
  const Rgb u = records_.unfiltered.empty() ? Rgb(0, 0, 0) : records_.unfiltered[i];
  const Vec3 filtered = u + records_.throughput[i] * estimates_.c_bar[i];
  const Vec3 input = u + records_.throughput[i] * records_.contribution[i];
  const bool finite = is_finite(filtered) && (role == filter::Role::query || is_finite(input));
  if (!finite) return PathFate::overflowed;
  return estimates_.neighbors[i] == 0 ? PathFate::orphan : PathFate::averaged;
}

void BlockExplainer::find_pairs(std::uint32_t i, std::vector<ExplainedPair>& pairs,
                                std::atomic<std::int64_t>& room) const {
  std::vector<search::Neighbor> found;
  std::vector<std::uint32_t> sources;
  std::vector<float> d_sq;
  for (const Kin& kin : kin_) {
    kin.search->within(records_.position[i], radius_[i] * radius_[i], found);
    for (const search::Neighbor& neighbor : found) {
      sources.push_back(kin.roles.sources[neighbor.index]);
      d_sq.push_back(neighbor.d_sq);
    }
  }
  take_room(sources.size() + 1, room);
  const auto add = [&](std::uint32_t j, float squared) {
    ExplainedPair pair;
    pair.vertex = j;
    pair.distance = scaled_->to_world(std::sqrt(squared));
    pair.self = j == i;
    pair.refusers = pair.self ? 0 : weights_->refusers(i, j, radius_[i]);
    pair.in_ball = true;
    pair.averaged = pair.refusers == 0;
    if (is_disk(i)) pair.area = area_[j];
    pairs.push_back(pair);
  };
  if (is_source(i)) add(i, 0);
  for (std::size_t k = 0; k < sources.size(); ++k) {
    if (sources[k] != i) add(sources[k], d_sq[k]);
  }
}

// Marks or adds the sources that an orphan averages; they have no areas.
void BlockExplainer::adopt(std::uint32_t i, std::vector<ExplainedPair>& pairs) const {
  const Kin& kin = kin_[records_.in_volume(i) ? 1 : 0];
  const filter::Problem problem{records_, kin.roles, radius_, weights_->like(i), {}};
  for (const std::uint32_t j : filter::adopt(*kin.search, problem, i).sources) {
    ExplainedPair& pair = pair_with(i, j, pairs);
    pair.averaged = true;
    pair.area = 1;
  }
}

ExplainedPair& BlockExplainer::pair_with(std::uint32_t i, std::uint32_t j,
                                         std::vector<ExplainedPair>& pairs) const {
  const auto known = std::find_if(pairs.begin(), pairs.end(),
                                  [j](const ExplainedPair& of) { return of.vertex == j; });
  if (known != pairs.end()) return *known;
  ExplainedPair& pair = pairs.emplace_back();
  pair.vertex = j;
  pair.distance =
      scaled_->to_world(std::sqrt(search::distance_sq(records_.position[i], records_.position[j])));
  pair.refusers = weights_->refusers(i, j, radius_[i]);
  return pair;
}

// Marks or adds the fireflies that give to path i.
void BlockExplainer::find_givers(std::uint32_t i, std::vector<ExplainedPair>& pairs,
                                 std::atomic<std::int64_t>& room) const {
  const std::size_t before = pairs.size();
  for (const filter::Fireflies& some : fireflies_) {
    some.each_giver(i, [&](std::uint32_t j, double share) {
      pair_with(i, j, pairs).given = static_cast<float>(share);
    });
  }
  take_room(pairs.size() - before, room);
}

void BlockExplainer::fit(ExplainedPath& path, std::span<ExplainedPair> pairs) const {
  if (parameters_.fit != filter::BallFit::linear || path.neighbors < 2) return;
  const std::uint32_t i = path.vertex;
  std::vector<FitSource> sources;
  for (const ExplainedPair& pair : pairs) {
    if (pair.averaged) sources.push_back({pair.vertex, value(pair.vertex)});
  }
  const std::optional<PathFit> fit = fit_path(records_, i, radius_[i], sources);
  if (!fit) return;
  path.fit = fit->of;
  if (parameters_.demodulate) path.fit->mean = remodulated(path.fit->mean, records_.reflectance[i]);
  auto beside = fit->beside.begin();
  for (ExplainedPair& pair : pairs) {
    if (pair.averaged) pair.beside = *beside++;
  }
}

double BlockExplainer::scale_of(std::uint32_t i, std::span<const ExplainedPair> pairs) const {
  if (is_disk(i) && estimates_.neighbors[i] > 0) {
    return 1 / (std::numbers::pi * double{radius_[i]} * double{radius_[i]});
  }
  const auto count = std::count_if(pairs.begin(), pairs.end(),
                                   [](const ExplainedPair& pair) { return pair.averaged; });
  return 1 / static_cast<double>(count);
}

}  // namespace psf::explain
