// The samples of psf-bench filter: records that are filtered as one block.
#pragma once

#include <cstddef>
#include <vector>

#include "filter/parameters/parameters.h"
#include "run/block_records.h"
#include "run/dump.h"

namespace psf::bench {

struct Sample {
  run::BlockRecords records;
  std::vector<filter::CameraView> cameras;
  std::vector<std::size_t> passes;  // first record of each whole pass, and the end of the last one
  // The defaults, except that the radius does not shrink, and terms whose channel is missing are
  // off.
  filter::Parameters parameters;

  [[nodiscard]] std::size_t size() const { return records.flags.size(); }
};

// A box of red, green and white walls with two white spheres under a square lamp. The records are
// first hits in scanline order, jittered within the pixel: 4 passes of a square picture, and then
// as many as are missing from `records`. The visibility bit of a record is that of one random lamp
// point, so bits differ in penumbrae.
[[nodiscard]] Sample make_box(std::size_t records);

// The first `records` paths of the dump, or all. Throws Error{bad_input} where none has a vertex.
[[nodiscard]] Sample read_sample(const run::Dump& dump, std::size_t records);

// The records [first, last).
[[nodiscard]] filter::Records part(const filter::Records& records, std::size_t first,
                                   std::size_t last);

}  // namespace psf::bench
