// Opening: finds the last commit and the index of all chunks up to it. README.md, "Opening".
#pragma once

#include <cstdint>
#include <vector>

#include "formats/commit.h"
#include "formats/file.h"
#include "formats/frame.h"
#include "formats/head.h"
#include "formats/reader.h"

namespace psf::formats {

struct Opened {
  Head head;
  Frame head_frame;
  Uuid uuid{};
  std::uint64_t file_size = 0;  // when it was opened
  Frame last;                   // the last commit
  Commit commit;
  std::vector<ChunkEntry> chunks;
  // The commit whose index begins with the first chunk and that the last one builds on: its offset,
  // and the chunks up to it. 0, 0 where a commit in between is unreadable.
  std::uint64_t root = 0, root_chunks = 0;
};

struct HeadFrame {
  Frame frame;
  Head head;
};

// Throws Error{bad_input} where no HEAD of version 1 stands at the start; `path` stands in the
// message.
[[nodiscard]] HeadFrame read_head(const File& file, std::uint64_t file_size);

// Throws Error{bad_input}: no path-vertex buffer, of a later version, without a commit, or damaged
// before its last commit so that the index is incomplete (the message has the record ranges).
[[nodiscard]] Opened open_buffer(const File& file);

// Says which frames of types that version 1 does not know may be skipped: throws where `prefix` may
// not.
void check_skippable(const Prefix& prefix, const Head& head);

}  // namespace psf::formats
