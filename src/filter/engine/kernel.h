// The vector code of the engine: 16 queries walk the tree together. Compiled for several
// instruction sets (Highway), chosen at run time; all give the same bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "filter/engine/ring_table.h"
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

// What a packet needs for several radii, of which Packet has the largest; borrowed. (16, rings) and
// so on are those of a RingTable.
struct RingPacket {
  alignas(64) float inverse_basis_sq[kWidth];  // 1 / f_i^2; NaN where it is not within the table's
                                               // limits: then every pair is compared
  const float* r;                              // (16, rings) world units
  const float* r_sq;                           // (16, rings)
  // What the walk adds to: sums of the values that pass, red, green, blue, and how many.
  double* sums;   // (16, rings + 1, 4); the last ring is of no use
  double* whole;  // (rings, 4), for every query
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

// The same by rings, for all radii of `table` in one walk; sets packet.met_itself too.
void average_rings(const Tree& tree, const WeightTerms& terms, const RingTable& table,
                   std::span<const std::uint32_t> parents, Packet& packet, RingPacket& rings);

// Adds to `counts` the pairs of the packet's queries with the sources below the given parents.
void count_pairs(const Tree& tree, const WeightTerms& terms, std::span<const std::uint32_t> parents,
                 const Packet& packet, PairCounts& counts);

}  // namespace psf::filter::engine
