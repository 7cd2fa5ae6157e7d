// [average] of one block for many radii at once: what a sweep over r0 and delta asks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/average.h"

namespace psf::filter {

// Who is given the averages. Queries come in slabs, one after the other, those of a slab in parts
// from several threads at once: always the same slabs and parts in the same order.
class Receiver {
 public:
  Receiver() = default;
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;
  virtual ~Receiver() = default;

  // What each record is; before the slabs of a traversal, and valid during them.
  virtual void set_roles(std::span<const Role> roles) { static_cast<void>(roles); }
  // Record numbers; those of part p are [p * grain, (p + 1) * grain).
  virtual void begin(std::span<const std::uint32_t> queries, std::size_t grain) = 0;
  // (queries of the part, count) c_bar, of the radii [first, first + count); each part once.
  virtual void take(std::size_t part, std::size_t first, std::size_t count,
                    std::span<const Rgb> c_bar) = 0;
  virtual void end() = 0;

  static constexpr std::size_t kMostQueries = std::size_t{1} << 14;  // of a slab
};

struct ManyAverages {
  std::vector<Role> roles;             // of each record, as Average has them
  std::vector<Statistics> statistics;  // of each radius; the seconds are of all together
};

// The same as average() for each of `radii`, which replace parameters.radius and share its basis
// and count, but that sums are added in another order. Every query of the block is given to
// `receiver` for every radius. One traversal for [average] and [disk]; iterations and the other
// estimators take one a radius. Throws what average() and the receiver throw.
[[nodiscard]] ManyAverages average_many(const Records& records, const Block& block,
                                        const Parameters& parameters, std::span<const Radius> radii,
                                        Receiver& receiver);

// Bytes of each record beside those of memory_per_record().
inline constexpr std::uint64_t kManyBytesPerRecord = sizeof(double);

}  // namespace psf::filter
