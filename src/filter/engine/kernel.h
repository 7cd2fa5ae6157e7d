// The vector code of the engine: 16 queries walk the tree together. Compiled for several
// instruction sets (Highway), chosen at run time; all give the same bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "filter/engine/tree.h"
#include "filter/weights.h"

namespace psf::filter::engine {

// A query a lane. What is averaged for a query, and in which order, follows from the queries of its
// packet, the tree and the list of parents alone, not from how many lanes a vector has.
struct Packet {
  // (columns, 16), as in the tree's plan, and the least and the greatest value of each column, at
  // low[column * kWidth] and high[column * kWidth]; borrowed.
  const float* columns;
  const float* low;
  const float* high;
  alignas(64) float r_sq[kWidth];         // squared world units; 0: nothing to find
  alignas(64) float plane_reach[kWidth];  // t r_i of `plane`

  // What the walk adds to: of the values that pass, and how many.
  alignas(64) double sum[3][kWidth];
  alignas(64) std::int32_t count[kWidth];
  // Out: whether the pair (i, i) passes chi and every term, for which a walk cannot know that it
  // must; not 0 if so.
  alignas(64) std::int32_t met_itself[kWidth];
};

// What a packet needs for several radii, of which Packet has the largest; all borrowed. Ring k
// holds what is in ball k and not in ball k - 1.
struct RingPacket {
  std::size_t count;  // of rings
  const float* r_sq;  // (count, 16) squared world units, ascending for each query
  // The least and the greatest of each ring, or less and more; infinity beyond count, up to a
  // multiple of 16.
  const float* least_r_sq;
  const float* greatest_r_sq;
  const float* plane_reach;  // (count, 16) t r_i of `plane`, where it is on
  // What the walk adds to: sums of the values that pass, red, green, blue, and how many.
  double* sums;   // (count + 1, 16, 4); the last ring is of no use
  double* whole;  // (count, 4), for every query
};

// What one query averages, for all radii; all borrowed, and written.
struct RingMeans {
  float* average;            // (count, 3), and one more; anything where there are no neighbours
  std::uint32_t* neighbors;  // (count)
  double* balls;             // (count, 4) red, green, blue and how many
  double* inverse;           // of how many; as long as RingPacket's least_r_sq
};

// Counts of pairs for the statistics, the pair (i, i) included.
struct PairCounts {
  std::uint64_t candidates = 0;                     // chi = 1
  std::array<std::uint64_t, kTermCount> refused{};  // of them, by term, whatever the others say
  PairCounts& operator+=(const PairCounts& other);
};

// The least value of each of `columns` rows of `lows`, (columns, 16), and the greatest of each of
// `highs`, to low[column * kWidth] and high[column * kWidth].
void extremes(const ColumnPlan& plan, std::size_t columns, const float* lows, const float* highs,
              float* low, float* high);

// Adds up, for every lane, the sources below the given parents of the tree that pass chi and every
// term that is on.
void average(const Tree& tree, const WeightTerms& terms, std::span<const std::uint32_t> parents,
             Packet& packet);

// The same by rings, for all radii in one walk; sets packet.met_itself too.
void average_rings(const Tree& tree, const WeightTerms& terms,
                   std::span<const std::uint32_t> parents, Packet& packet, const RingPacket& rings);

// Of the q-th query of the packet, whose rings are complete.
void average_balls(const RingPacket& rings, std::size_t q, const RingMeans& means);

// Adds to `counts` the pairs of the packet's queries with the sources below the given parents.
void count_pairs(const Tree& tree, const WeightTerms& terms, std::span<const std::uint32_t> parents,
                 const Packet& packet, PairCounts& counts);

}  // namespace psf::filter::engine
