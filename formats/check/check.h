// Checks a whole path-vertex buffer: every frame, every checksum, every total, every padding byte.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "formats/layout/head.h"

namespace psf::formats {

struct Fault {
  std::uint64_t offset = 0;              // of the frame, or of the first page without a valid frame
  std::string frame;                     // HEAD, SLOT, CHNK, ...; empty: no frame can be read
  std::optional<std::uint64_t> chunk;    // number of the chunk in its table, from 0
  std::string channel;                   // channel of the column; empty: the frame as a whole
  std::uint64_t first = 0, records = 0;  // range of lost or doubtful records; records 0: none
  std::string message;
  std::string table = {};  // to which chunk and records belong; empty: the paths

  [[nodiscard]] std::string text() const;  // one line
};

struct CheckResult {
  Head head;
  std::uint64_t file_bytes = 0, uncommitted_bytes = 0;
  std::uint64_t frames = 0, chunks = 0, columns = 0,
                commits = 0;                 // readable ones up to the last commit
  std::uint64_t records = 0, passes = 0;     // as the last commit says
  std::vector<std::uint64_t> table_records;  // of the tables, in their order
  bool closed = false;
  std::vector<Fault> faults;  // sorted by offset
};

// Checks a file. Calls `progress(done, total)` with bytes, from the calling thread. Throws
// Error{bad_input} where the file is no path-vertex buffer of version 1 with a commit, so that
// there is nothing to check, and Error{io} where it cannot be read.
[[nodiscard]] CheckResult check(
    const std::string& path,
    const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

}  // namespace psf::formats
