// What a pair of an explanation adds to its path, and in what its two records differ.
#pragma once

#include <cstdint>
#include <optional>

#include "explain/explain.h"

namespace psf::explain {

// Whether the path has light from the source: averaged, or given by a firefly.
[[nodiscard]] inline bool brings_light(const ExplainedPair& pair) {
  return pair.averaged || pair.given > 0;
}

// `value` times rho, as filter::remodulate() in double.
[[nodiscard]] inline Colour remodulated(Colour value, const Rgb& rho) {
  for (int c = 0; c < 3; ++c) value[c] *= rho[c] > 0 ? double{rho[c]} : 1;
  return value;
}

// With what weight ExplainResult::value of the source enters c_bar_i, for each colour; with [fit] it
// may be below 0. 0 where the source is not averaged.
[[nodiscard]] Colour weight_of(const ExplainResult& explanation, const ExplainedPair& pair);

// c_bar_i if the mean were in place of the fit.
[[nodiscard]] inline Colour if_mean(const ExplainedPath& path) {
  return path.fit ? path.fit->mean + wide(path.given) : wide(path.c_bar);
}

// What a pair adds to a pixel of `paths` paths, and the part of that which the source gives as a
// firefly.
[[nodiscard]] Colour share_of(const ExplainResult& explanation, const ExplainedPair& pair,
                              std::uint64_t paths);
[[nodiscard]] Colour given_of(const ExplainResult& explanation, const ExplainedPair& pair,
                              std::uint64_t paths);

// The firefly at a vertex; null: it is none.
[[nodiscard]] const ExplainedFirefly* firefly_at(const ExplainResult& explanation,
                                                 std::uint32_t vertex);

// The differences between a source and the vertex that averages it; not set where the file lacks
// the channel.
struct PairFeatures {
  std::optional<double> angle;          // between the normals, degrees
  std::optional<double> reflectance;    // norm of the difference
  std::optional<std::uint32_t> lights;  // visibility bits that differ
  std::optional<double> hit_distance;   // relative difference; infinity: one is a miss
  std::optional<double> plane;          // distance off the plane in radii; > 0 on the normal's side
  std::optional<double> direction;      // angle between the directions, degrees
  std::optional<bool> material;         // whether the materials differ
};
[[nodiscard]] PairFeatures features_of(const ExplainResult& explanation, const ExplainedPair& pair);

}  // namespace psf::explain
