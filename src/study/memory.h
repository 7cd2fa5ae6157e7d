// What memory a filter run takes at most, known before it starts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "filter/parameters.h"
#include "study/dump.h"

namespace psf::study {

// Bytes. Pages of files are not counted: the reader maps none, so only the program's own code is.
struct MemoryEstimate {
  std::uint64_t program = 0;   // libraries, threads, and what the reader and the allocator keep
  std::uint64_t pictures = 0;  // sums, and writing them
  std::uint64_t block = 0;     // the records of the longest block, of the channels that are read
  std::uint64_t blocks = 1;    // of them in memory: 2 where the next one is read ahead
  std::uint64_t filter = 0;    // what average() needs beside them
  // The longest block as the file has it, Head::stride() bytes a record: the measure of the target,
  // blocks * block + filter <= 3 * stored.
  std::uint64_t stored = 0;

  [[nodiscard]] std::uint64_t total() const { return program + pictures + blocks * block + filter; }
};

struct MemoryRequest {
  const filter::Parameters& parameters;
  std::size_t first_pass, last_pass;   // [first, last)
  std::optional<std::uint64_t> limit;  // bytes
  std::uint64_t bytes_a_pixel;         // of all pictures, and of writing them
  std::uint64_t beside = 0;            // bytes that the run takes beside the filter,
  std::uint64_t beside_a_record = 0;   // and of each record of a block
};

// With several threads and blocks it is for two blocks, unless they exceed the limit. Throws
// Error{limit} where not even one at a time keeps it, which says what block would.
[[nodiscard]] MemoryEstimate plan_memory(const Dump& dump, const ChannelSet& channels,
                                         const MemoryRequest& request);

// Whether plan_memory() would find it possible.
[[nodiscard]] bool fits_memory(const Dump& dump, const ChannelSet& channels,
                               const MemoryRequest& request);

// The most memory that this process ever had, in bytes.
struct PeakMemory {
  std::uint64_t process = 0;  // as the system counts it
  std::uint64_t own = 0;      // without pages of files, the code: what an estimate is about
};
// Linux's figures; `own` takes it that the pages of files have not become fewer since the peak.
[[nodiscard]] PeakMemory peak_memory();

}  // namespace psf::study
