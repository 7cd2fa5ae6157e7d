// Visits every frame of a file, valid or not, for a check.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "formats/check.h"
#include "formats/commit.h"
#include "formats/file.h"
#include "formats/frame.h"
#include "formats/open.h"

namespace psf::formats {

struct WalkedChunk {
  ChunkEntry entry;
  bool readable = false;  // its frame is; its columns are still to be checked
};

struct WalkedCommit {
  Frame frame;
  Commit commit;
};

// Pages where no valid frame stands.
struct Region {
  std::uint64_t begin = 0, end = 0;
  std::string fault;
};

struct Walk {
  HeadFrame head;
  std::uint64_t file_size = 0;
  std::uint64_t end = 0;       // of the last commit; 0: there is none
  std::vector<Prefix> frames;  // of all valid frames but HEAD
  std::vector<WalkedCommit> commits;
  std::map<std::uint64_t, WalkedChunk> chunks;  // by offset
  std::vector<Region> bad;
  std::vector<Fault> faults;

  [[nodiscard]] const Uuid& uuid() const { return head.frame.prefix.uuid; }
};

// Of a file whose HEAD is `head`. Throws Error{bad_input} where a frame must be understood and is
// not.
[[nodiscard]] Walk walk_frames(const File& file, HeadFrame head);

// Forgets what lies from `end` on.
void drop_behind(Walk& walk, std::uint64_t end);

}  // namespace psf::formats
