// How much memory average() needs for a block, so that a run can be refused before it starts.
#pragma once

#include <cstdint>

#include "filter/parameters.h"

namespace psf::filter {

// Bytes a record at most, beside the records themselves; the radius is counted here.
[[nodiscard]] inline std::uint64_t memory_per_record(const Parameters& parameters) {
  constexpr std::uint64_t kVector = 12, kWord = 4;
  constexpr std::uint64_t kResult = kVector + kWord + 1;  // c_bar, neighbours, role
  constexpr std::uint64_t kLists = 2 * kWord;             // queries and sources
  constexpr std::uint64_t kRadius = kWord;
  constexpr std::uint64_t kSums = 24;     // the values averaged, three doubles
  constexpr std::uint64_t kGroups = 8;    // bounds and sums of groups of records
  constexpr std::uint64_t kSorting = 16;  // keys and numbers while the curve's order is made

  const WeightTerms& terms = parameters.weights;
  const bool disk = parameters.estimator == Estimator::disk;
  std::uint64_t sorted = kVector;  // positions, and what the terms compare, along the curve
  if (terms.normal || terms.plane || disk) sorted += kVector;
  if (terms.reflectance) sorted += kVector;
  if (terms.visibility) sorted += kWord;
  if (terms.hit_distance) sorted += kWord;
  if (terms.direction) sorted += kVector;
  if (terms.material) sorted += kWord;

  std::uint64_t bytes = kResult + kLists + kRadius + sorted + kSums + kGroups + kSorting;
  if (parameters.demodulate || parameters.iterations > 1) bytes += kVector;  // what is averaged
  if (disk) bytes += kWord;                                                  // areas
  return bytes;
}

}  // namespace psf::filter
