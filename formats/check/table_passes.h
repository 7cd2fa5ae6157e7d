// The chunks that a walk found of the tables, by pass, and which passes are there as a whole.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "formats/check/check.h"
#include "formats/check/walk.h"

namespace psf::formats {

struct TablePass {
  struct Numbered {
    WalkedChunk chunk;
    std::uint64_t number = 0;  // in its table
  };
  std::vector<Numbered> chunks;  // in order; at least one
  bool whole = true;             // no chunk is missing, and every frame is readable
  bool taken = false;            // for the caller: the pass was saved
};

struct TablePasses {
  std::map<std::uint32_t, TablePass> passes;  // those with chunks
  std::vector<Fault> gaps;                    // committed records of which nothing was found
};

// One for each table, in their order. A pass that no commit counts is never whole: nothing says
// where it ends.
[[nodiscard]] std::vector<TablePasses> table_passes(const Walk& walk);

}  // namespace psf::formats
