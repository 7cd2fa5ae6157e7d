// The head of a path-vertex buffer that is joined from others: their channels and metadata are
// compared and merged.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/layout/head.h"
#include "formats/read/reader.h"
#include "formats/write/concatenate.h"

namespace psf::formats {

// Passes [first, last) of a file, at least one.
struct JoinedInput {
  const Reader& reader;
  std::uint64_t first = 0, last = 0;
};

struct JoinedChannel {
  std::size_t source = 0;  // number of the channel in the inputs
  Channel channel;         // the channel as written
  bool quantized = false;
};

struct JoinedTable {
  std::size_t source = 0;  // number of the table in the inputs, as Head::schema() counts
  std::vector<JoinedChannel> channels;
};

struct JoinedHead {
  Head head;
  std::vector<JoinedTable> tables;  // the first are the paths
  std::vector<std::string> notes;   // remarks about inputs that are allowed but unusual
};

// Throws Error{bad_input} that names a file that differs from the first in scene, channels, tables,
// cameras or the way of rendering, or that lacks a channel; Error{usage} that names a channel that cannot
// be dropped or quantised.
[[nodiscard]] JoinedHead join_heads(std::span<const JoinedInput> inputs,
                                    const ConcatenateOptions& options);

}  // namespace psf::formats
