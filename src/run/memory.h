// The most memory that a filter run takes, estimated before it starts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "filter/parameters/parameters.h"
#include "run/dump.h"

namespace psf::run {

// All figures are bytes. Pages of files are not counted; the reader maps none, so these are the
// program's code alone.
struct MemoryEstimate {
  std::uint64_t program = 0;   // libraries, threads, and buffers of the reader and the allocator
  std::uint64_t pictures = 0;  // sums of the pictures, and buffers to write them
  std::uint64_t block = 0;     // the records of the longest block, only the channels that are read
  std::uint64_t blocks = 1;    // number of blocks in memory; 2 where the next one is read ahead
  std::uint64_t filter = 0;    // what estimate() needs in addition to the blocks
  // The longest block as stored in the file, Head::stride() bytes per record. The target is
  // blocks * block + filter <= 3 * stored.
  std::uint64_t stored = 0;

  [[nodiscard]] std::uint64_t total() const { return program + pictures + blocks * block + filter; }
};

struct MemoryRequest {
  const filter::Parameters& parameters;
  std::size_t first_pass, last_pass;   // [first, last)
  std::optional<std::uint64_t> limit;  // bytes
  std::uint64_t bytes_a_pixel;         // for all pictures, and for writing them
  std::uint64_t beside = 0;            // bytes that the run takes in addition to the filter
  std::uint64_t beside_a_record = 0;   // the same, per record of a block
  bool window = false;                 // with blocks of other frames, one after the other
};

// Estimates the memory of a run. With several threads and blocks the estimate is for two blocks,
// unless these exceed the limit. Throws Error{limit} where even one block at a time exceeds it; the
// message names a block size that fits.
[[nodiscard]] MemoryEstimate plan_memory(const Dump& dump, const ChannelSet& channels,
                                         const MemoryRequest& request);

// Whether plan_memory() finds a plan for the request instead of throwing.
[[nodiscard]] bool fits_memory(const Dump& dump, const ChannelSet& channels,
                               const MemoryRequest& request);

// The most memory that this process ever had, in bytes.
struct PeakMemory {
  std::uint64_t process = 0;  // as the system counts it
  std::uint64_t own = 0;      // without pages of files, that is, code; what estimates are about
};
// The figures are Linux's; `own` assumes that the pages of files have not become fewer since the
// peak.
[[nodiscard]] PeakMemory peak_memory();

}  // namespace psf::run
