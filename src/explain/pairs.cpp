#include "explain/pairs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "filter/values.h"
#include "search/ball.h"

namespace psf::explain {
namespace {

// `value`, of source j, as path i has it.
Colour as_seen(const ExplainResult& e, const ExplainedPath& path, const Rgb& value) {
  const bool demodulated = e.request.parameters.demodulate;
  return wide(demodulated ? filter::remodulate(value, e.vertices.reflectance[path.vertex]) : value);
}

}  // namespace

Colour weight_of(const ExplainResult& explanation, const ExplainedPair& pair) {
  if (!pair.averaged) return {0, 0, 0};
  const ExplainedPath& path = explanation.paths[pair.path];
  const Colour weight = Colour(1, 1, 1) * double{pair.area} * path.scale;
  return path.fit ? weight + path.fit->taken * double{pair.beside} : weight;
}

Colour share_of(const ExplainResult& explanation, const ExplainedPair& pair, std::uint64_t paths) {
  const ExplainedPath& path = explanation.paths[pair.path];
  const auto n = static_cast<double>(paths);
  Colour share(0, 0, 0);
  if (pair.averaged) {
    const Colour light = wide(explanation.vertices.throughput[path.vertex]) *
                         as_seen(explanation, path, explanation.value[pair.vertex]);
    share = light * double{pair.area} * path.scale / n;
    if (path.fit) share += light * path.fit->taken * double{pair.beside} / n;
  }
  return pair.given > 0 ? share + given_of(explanation, pair, paths) : share;
}

Colour given_of(const ExplainResult& explanation, const ExplainedPair& pair, std::uint64_t paths) {
  if (!(pair.given > 0)) return {0, 0, 0};
  const ExplainedPath& path = explanation.paths[pair.path];
  const run::BlockRecords& v = explanation.vertices;
  Rgb value = v.contribution[pair.vertex];  // also where what is averaged is of an iteration
  if (explanation.request.parameters.demodulate) {
    value = filter::demodulate(value, v.reflectance[pair.vertex]);
  }
  return wide(v.throughput[path.vertex]) * as_seen(explanation, path, value) * double{pair.given} /
         static_cast<double>(paths);
}

const ExplainedFirefly* firefly_at(const ExplainResult& explanation, std::uint32_t vertex) {
  const auto& all = explanation.fireflies;
  const auto at = std::lower_bound(
      all.begin(), all.end(), vertex,
      [](const ExplainedFirefly& firefly, std::uint32_t v) { return firefly.vertex < v; });
  return at != all.end() && at->vertex == vertex ? &*at : nullptr;
}

PairFeatures features_of(const ExplainResult& explanation, const ExplainedPair& pair) {
  const run::BlockRecords& v = explanation.vertices;
  const ExplainedPath& path = explanation.paths[pair.path];
  const std::uint32_t i = path.vertex, j = pair.vertex;
  const auto degrees = [](const Vec3& a, const Vec3& b) {
    return std::acos(std::clamp(double{dot(a, b)}, -1.0, 1.0)) * 180 / std::numbers::pi;
  };
  PairFeatures features;
  if (!v.normal.empty() && !in_volume(v, i) && !in_volume(v, j)) {
    features.angle = degrees(v.normal[i], v.normal[j]);
    const Vec3 to_j(v.position[j].x - v.position[i].x, v.position[j].y - v.position[i].y,
                    v.position[j].z - v.position[i].z);
    features.plane = path.radius > 0 ? double{dot(to_j, v.normal[i])} / double{path.radius} : 0;
  }
  if (!v.reflectance.empty()) {
    features.reflectance =
        std::sqrt(double{search::distance_sq(v.reflectance[i], v.reflectance[j])});
  }
  if (!v.visibility.empty()) features.lights = v.visibility[i] ^ v.visibility[j];
  if (!v.hit_distance.empty()) {
    const auto h_i = double{v.hit_distance[i]}, h_j = double{v.hit_distance[j]};
    const double longer = std::max(h_i, h_j);
    features.hit_distance = h_i == h_j           ? 0
                            : std::isinf(longer) ? longer
                                                 : std::abs(h_i - h_j) / longer;
  }
  if (!v.direction.empty()) features.direction = degrees(v.direction[i], v.direction[j]);
  if (!v.material.empty()) features.material = v.material[i] != v.material[j];
  return features;
}

}  // namespace psf::explain
