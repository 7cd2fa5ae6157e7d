// Opens a file: finds the last commit and the index of all chunks up to it. README.md, "Opening".
#pragma once

#include <cstdint>
#include <vector>

#include "formats/layout/commit.h"
#include "formats/layout/entries.h"
#include "formats/layout/file.h"
#include "formats/layout/frame.h"
#include "formats/layout/head.h"

namespace psf::formats {

struct Opened {
  Head head;
  Frame head_frame;
  Uuid uuid{};
  std::uint64_t file_size = 0;  // size of the file when it was opened
  Frame last;                   // the last commit
  Commit commit;
  std::vector<std::vector<ChunkEntry>> chunks;  // of each table; the first are those of the paths
  // The offset of the commit whose index begins with the first chunk and on which the last commit
  // builds, and the number of chunks of each table up to it. The offset is 0 where a commit in
  // between is unreadable.
  std::uint64_t root = 0;
  std::vector<std::uint64_t> root_chunks;
};

struct HeadFrame {
  Frame frame;
  Head head;
};

// Reads the frame HEAD. Throws Error{bad_input} that names the file where no HEAD of version 1 is
// at its start.
[[nodiscard]] HeadFrame read_head(const File& file, std::uint64_t file_size);

// Opens a file. Throws Error{bad_input} where it is no path-vertex buffer, was written by a later
// version, has no commit, or is damaged before its last commit so that the index is incomplete (the
// message has the record ranges).
[[nodiscard]] Opened open_buffer(const File& file);

// Throws where the frame `prefix`, of a type that version 1 does not know, must not be skipped.
void check_skippable(const Prefix& prefix, const Head& head);

}  // namespace psf::formats
