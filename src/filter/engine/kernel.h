// The vector code of the engine: 16 queries walk the tree together. Compiled for several
// instruction sets (Highway), chosen at run time; all give the same bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "filter/engine/fit_packet.h"
#include "filter/engine/found.h"
#include "filter/engine/tree.h"
#include "filter/engine/tree_sums.h"
#include "filter/weights.h"

namespace psf::filter::engine {

// Sixteen queries, one per lane. Which sources are averaged for a query, and in which order,
// depends on the queries of its packet, the tree and the list of parents alone, not on how many
// lanes a vector has.
struct Packet {
  // The queries' columns, (columns, 16), in the order of the tree's plan, and the least and the
  // greatest value of each column, at low[column * kWidth] and high[column * kWidth]. All are
  // borrowed.
  const float* columns;
  const float* low;
  const float* high;
  alignas(64) float r_sq[kWidth];         // r_i^2, squared world units; 0: finds nothing
  alignas(64) float plane_reach[kWidth];  // t r_i of `plane`

  // The walk adds the values of the sources that pass to `sum`, and their number to `count`.
  alignas(64) double sum[3][kWidth];
  alignas(64) std::int32_t count[kWidth];
  // Set by the walk: not 0 where the pair (i, i) passes chi and every term. Where it is 0, the walk
  // did not count the query's own record, which always counts, and the caller has to add it.
  alignas(64) std::int32_t met_itself[kWidth];
};

// What a packet needs in addition for several radii; Packet::r_sq holds the largest. Ring k is ball
// k without ball k - 1. All pointers are borrowed.
struct RingPacket {
  std::size_t count;  // number of rings
  const float* r_sq;  // (count, 16) squared world units, ascending for each query
  // Bounds of r_sq over the queries, for each ring: least_r_sq is at most, greatest_r_sq at least
  // every r_sq. Both are infinity from `count` up to the next multiple of 16.
  const float* least_r_sq;
  const float* greatest_r_sq;
  const float* plane_reach;  // (count, 16) t r_i of `plane`, where it is on
  // The walk adds to these the values that pass: red, green, blue, and the number of sources.
  double* sums;   // (count + 1, 16, 4) for each query; the last ring holds nothing of use
  double* whole;  // (count, 4) sums that belong to every query
};

// The results of average_balls() for one query and all radii. All pointers are borrowed.
struct RingMeans {
  float* average;            // (count, 3), and one value more; undefined without neighbours
  std::uint32_t* neighbors;  // (count) number of sources in each ball
  double* balls;             // (count, 4) sums of red, green and blue, and the number of sources
  double* inverse;           // 1 / number of sources; as long as RingPacket's least_r_sq
};

// Counts of pairs for the statistics, the pair (i, i) included.
struct PairCounts {
  std::uint64_t candidates = 0;                     // chi = 1
  std::array<std::uint64_t, kTermCount> refused{};  // candidates that each term alone refuses
  PairCounts& operator+=(const PairCounts& other);
};

// Writes the least value of each row of `lows`, (columns, 16), to low[column * kWidth], and the
// greatest value of each row of `highs`, (columns, 16), to high[column * kWidth].
void extremes(const ColumnPlan& plan, std::size_t columns, const float* lows, const float* highs,
              float* low, float* high);

// Adds to the sums and counts of each query of `packet` the sources below the given parents that
// pass chi and every term that is on. Sets packet.met_itself. `sums` are of the tree.
void add_sources(const Tree& tree, const TreeSums& sums, const WeightTerms& terms,
                 std::span<const std::uint32_t> parents, Packet& packet);

// The same in two steps, for several values of each source: every pair is tested once. Step one
// sets `found`, and packet.count and packet.met_itself; step two sets `out`, (values, 3, 16) sums
// of each query, to what add_sources() makes of zeros for each value alone, bit for bit. `out` is
// aligned to 64 bytes.
void find_sources(const Tree& tree, const WeightTerms& terms,
                  std::span<const std::uint32_t> parents, Packet& packet, Found& found);
void add_found(std::span<const TreeSums> sums, const Found& found, double* out);

// Appends what was found to the list of each query: places in the tree's order.
void list_found(const Tree& tree, const Found& found,
                std::array<std::vector<std::uint32_t>, kWidth>& places);

// For [fit]: sets the moments of `fit` over what was found; with its weights, sets `out`, (values, 3,
// 16), to the sums of weight times value. Neither knows of queries that the walk did not meet.
void find_moments(const Tree& tree, const FitSources& sources, const Found& found,
                  const Packet& packet, FitPacket& fit);
void add_by_weight(const Tree& tree, const FitSources& sources, std::span<const TreeSums> sums,
                   const Found& found, const Packet& packet, const FitPacket& fit, double* out);

// Sets `means`, as many as `sums`, (rows, 16), to the sums over packet.count, in double and rounded
// to float; what no source was added to is undefined. Both are aligned to 64 bytes.
void average_sums(const Packet& packet, std::span<const double> sums, float* means);

// Does the same as add_sources() for all radii in one walk, but adds each source to its ring in
// `rings`. Sets packet.met_itself.
void add_to_rings(const Tree& tree, const TreeSums& sums, const WeightTerms& terms,
                  std::span<const std::uint32_t> parents, Packet& packet, const RingPacket& rings);

// Computes `means` of the q-th query of the packet from `rings`, after add_to_rings().
void average_balls(const RingPacket& rings, std::size_t q, const RingMeans& means);

// Adds to `counts` the pairs of the packet's queries with the sources below the given parents.
void count_pairs(const Tree& tree, const WeightTerms& terms, std::span<const std::uint32_t> parents,
                 const Packet& packet, PairCounts& counts);

}  // namespace psf::filter::engine
