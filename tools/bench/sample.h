// What psf-bench filter measures on: records that are filtered as one block.
#pragma once

#include <cstddef>
#include <vector>

#include "filter/parameters.h"
#include "study/block_records.h"
#include "study/dump.h"

namespace psf::bench {

struct Sample {
  study::BlockRecords records;
  std::vector<filter::CameraView> cameras;
  std::vector<std::size_t> passes;  // first record of each whole pass, and the end of the last one
  // Defaults, but that the radius does not shrink and terms are off whose channel there is not.
  filter::Parameters parameters;

  [[nodiscard]] std::size_t size() const { return records.flags.size(); }
};

// A box of red, green and white walls with two white spheres under a square lamp, first hits in
// scanline order, jittered within the pixel: 4 passes of a square picture and what is left over to
// `records`. One lamp point a record says what is lit, so that visibility bits differ in penumbrae.
[[nodiscard]] Sample make_box(std::size_t records);

// The first `records` paths of the dump, or all. Throws Error{bad_input} where none has a vertex.
[[nodiscard]] Sample read_sample(const study::Dump& dump, std::size_t records);

// Records [first, last) alone.
[[nodiscard]] filter::Records part(const filter::Records& records, std::size_t first,
                                   std::size_t last);

}  // namespace psf::bench
