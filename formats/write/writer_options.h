// How a path-vertex buffer is written.
#pragma once

#include <optional>

#include "formats/layout/entries.h"
#include "formats/layout/head.h"

namespace psf::formats {

struct WriterOptions {
  Codec codec = Codec::zstd;  // zstd after a 4-byte shuffle, for each column that it makes smaller
  bool sync = true;           // fdatasync before and after each commit
  std::optional<Uuid> uuid;   // uuid of the file; random unless given
};

}  // namespace psf::formats
