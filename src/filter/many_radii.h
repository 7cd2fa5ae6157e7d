// An estimator on one block for many radii at once, for sweeps over r0 and delta.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/estimate.h"

namespace psf::filter {

// Receives the averages. Queries come in slabs, one after the other; the parts of a slab come from
// several threads at once. Slabs and parts are always the same.
class Receiver {
 public:
  Receiver() = default;
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;
  virtual ~Receiver() = default;

  // Called before the slabs of a traversal with the role of each record; valid during the
  // traversal.
  virtual void set_roles(std::span<const Role> roles) { static_cast<void>(roles); }
  // Begins a slab. `queries`: record numbers, valid until end(); part p of the slab is [p * grain,
  // (p + 1) * grain) of them.
  virtual void begin(std::span<const std::uint32_t> queries, std::size_t grain) = 0;
  // Takes c_bar, (queries of the part, count), of a part for the radii [first, first + count).
  virtual void take(std::size_t part, std::size_t first, std::size_t count,
                    std::span<const Rgb> c_bar) = 0;
  virtual void end() = 0;

  static constexpr std::size_t kMostQueries = std::size_t{1} << 14;  // in a slab
};

struct ManyEstimates {
  std::vector<Role> roles;             // role of each record, as in Estimates
  std::vector<Statistics> statistics;  // one per radius; the seconds are for all radii together
};

// Estimates like estimate() for each of `radii`, which replace parameters.radius and have its basis
// and count; only the order of sums differs. Every query of the block is given to `receiver` for
// every radius. Where the estimator shares a traversal there is one for all, but iterations take
// one per radius. Throws what estimate() and the receiver throw.
[[nodiscard]] ManyEstimates estimate_many(const Records& records, const Block& block,
                                          const Parameters& parameters,
                                          std::span<const Radius> radii, Receiver& receiver);

// Bytes per record in addition to those of memory_per_record().
inline constexpr std::uint64_t kManyBytesPerRecord = sizeof(double);

}  // namespace psf::filter
