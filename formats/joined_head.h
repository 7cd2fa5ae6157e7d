// What a path-vertex buffer that is made of others declares: their channels and metadata, compared
// and merged.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/concatenate.h"
#include "formats/head.h"
#include "formats/reader.h"

namespace psf::formats {

// Passes [first, last) of a file, at least one.
struct JoinedInput {
  const Reader& reader;
  std::uint64_t first = 0, last = 0;
};

struct JoinedChannel {
  std::size_t source = 0;  // its number in the inputs
  Channel channel;         // as written
  bool quantized = false;
};

struct JoinedHead {
  Head head;
  std::vector<JoinedChannel> channels;
  std::vector<std::string> notes;  // what is allowed and yet worth a look
};

// Throws Error{bad_input} naming the file that is not of the same scene, channels, cameras or way
// of rendering as the first, or that lacks a channel, Error{usage} naming one that cannot be
// dropped or quantised.
[[nodiscard]] JoinedHead join_heads(std::span<const JoinedInput> inputs,
                                    const ConcatenateOptions& options);

}  // namespace psf::formats
