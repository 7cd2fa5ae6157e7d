// The memory that average() needs for a block, so that a run can be refused before it starts.
#pragma once

#include <cstdint>

#include "filter/parameters/parameters.h"

namespace psf::filter {

// The most bytes per record that average() needs, radii included, in addition to the records
// themselves. The sort's 44 bytes are freed before the tree, which needs more, is built. Not
// counted are 20 bytes of scaled.h, which only a block with unusually large or small lengths needs.
[[nodiscard]] inline std::uint64_t memory_per_record(const Parameters& parameters) {
  constexpr std::uint64_t kVector = 12, kWord = 4, kSum = 24;  // 3 floats, 1 float, 3 doubles
  constexpr std::uint64_t kGroup = 16, kQuad = 4;              // records of nodes in engine/tree.h
  constexpr std::uint64_t kResult = kVector + kWord + 1;       // c_bar, neighbours, role
  constexpr std::uint64_t kLists = 4 * kWord;  // queries and sources, ascending and in order
  constexpr std::uint64_t kRadius = kWord;
  constexpr std::uint64_t kQuads = (2 * kVector + kSum) / kQuad;

  const WeightTerms& terms = parameters.weights;
  const bool disk = parameters.estimator == Estimator::disk;
  std::uint64_t columns = kVector;  // positions, and what the terms compare
  if (terms.normal || terms.plane || terms.gloss) columns += kVector;
  if (terms.reflectance) columns += kVector;
  if (terms.visibility) columns += kWord;
  if (terms.hit_distance) columns += kWord;
  if (terms.direction || terms.gloss) columns += kVector;
  if (terms.material) columns += kWord;
  if (terms.gloss) columns += kWord;
  const std::uint64_t groups = (2 * columns + kSum + kGroup - 1) / kGroup;
  constexpr std::uint64_t kParents = 2;  // per 256 records: node, point of the index, statistics

  std::uint64_t bytes = kResult + kLists + kRadius + columns + kSum + kQuads + groups + kParents;
  if (parameters.demodulate || parameters.iterations > 1) bytes += kVector;  // values to average
  if (disk) bytes += kWord;                                                  // areas
  // [hash] has a key, its hash, two entries to sort, and places in cells, twice for orphans; it has
  // no tree.
  if (parameters.estimator == Estimator::hash)
    bytes = kResult + kLists + kRadius + 96 + 64 + kVector;
  // [control] has values, means, moments and the roles of a half; its tree is smaller.
  if (parameters.estimator == Estimator::control) bytes += 3 * kVector + 3 * kWord + 1;
  // [adaptive] has radii in float and in double, and luminances. Its tree for rings is freed before
  // the tree for averages is built.
  if (parameters.estimator == Estimator::adaptive) bytes += kWord + 2 * kWord + kVector;
  return bytes;
}

}  // namespace psf::filter
