// How much memory average() needs for a block, so that a run can be refused before it starts.
#pragma once

#include <cstdint>

#include "filter/parameters.h"

namespace psf::filter {

// Bytes a record at most, beside the records themselves; the radius is counted here. What the sort
// needs (44) is given back before the tree is built, which needs more.
// Not counted: 20 bytes of scaled.h, for a block whose lengths need another unit, as no usual ones
// do.
[[nodiscard]] inline std::uint64_t memory_per_record(const Parameters& parameters) {
  constexpr std::uint64_t kVector = 12, kWord = 4, kSum = 24;  // three floats; three doubles
  constexpr std::uint64_t kGroup = 16, kQuad = 4;              // records, of engine/tree.h
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
  constexpr std::uint64_t kParents = 2;  // for 256: a node, a point of the index, statistics

  std::uint64_t bytes = kResult + kLists + kRadius + columns + kSum + kQuads + groups + kParents;
  if (parameters.demodulate || parameters.iterations > 1) bytes += kVector;  // what is averaged
  if (disk) bytes += kWord;                                                  // areas
  // A key, its hash, two entries to sort, places in cells, twice where there are orphans; no tree.
  if (parameters.estimator == Estimator::hash)
    bytes = kResult + kLists + kRadius + 96 + 64 + kVector;
  // Values, means and moments, the roles of a half; its tree is smaller.
  if (parameters.estimator == Estimator::control) bytes += 3 * kVector + 3 * kWord + 1;
  // Radii, those in double, luminances; the rings' tree is gone before that of the averages is
  // made.
  if (parameters.estimator == Estimator::adaptive) bytes += kWord + 2 * kWord + kVector;
  return bytes;
}

}  // namespace psf::filter
