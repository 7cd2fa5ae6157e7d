// Visits every frame of a file, valid or not, for a check.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "formats/check/check.h"
#include "formats/layout/commit.h"
#include "formats/layout/file.h"
#include "formats/layout/frame.h"
#include "formats/read/open.h"

namespace psf::formats {

struct WalkedChunk {
  std::size_t table = 0;  // as Head::schema() counts
  ChunkEntry entry;
  bool readable = false;  // the frame is readable; its columns are still to be checked
};

struct WalkedCommit {
  Frame frame;
  Commit commit;
};

// A range of pages without a valid frame.
struct Region {
  std::uint64_t begin = 0, end = 0;
  std::string fault;
};

struct Walk {
  HeadFrame head;
  std::uint64_t file_size = 0;
  std::uint64_t end = 0;       // end of the last commit; 0: there is no commit
  std::vector<Prefix> frames;  // prefixes of all valid frames except HEAD
  std::vector<WalkedCommit> commits;
  std::map<std::uint64_t, WalkedChunk> chunks;  // of paths and tables, by offset
  std::vector<Region> bad;
  std::vector<Fault> faults;

  [[nodiscard]] const Uuid& uuid() const { return head.frame.prefix.uuid; }
};

// Walks over the frames of a file whose HEAD is `head`. Throws Error{bad_input} for a required
// frame of an unknown type.
[[nodiscard]] Walk walk_frames(const File& file, HeadFrame head);

// Takes the region that begins at `begin` out of the bad ones: what it is was told by its name.
void drop_region(Walk& walk, std::uint64_t begin);

// Removes from `walk` everything from the offset `end` on.
void drop_behind(Walk& walk, std::uint64_t end);

}  // namespace psf::formats
