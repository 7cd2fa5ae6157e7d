// Visits the frames of a file that is being opened.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "core/error.h"
#include "formats/layout/commit.h"
#include "formats/layout/frame.h"
#include "formats/layout/layout.h"
#include "formats/read/open.h"

namespace psf::formats {

struct FoundCommit {
  Frame frame;
  Commit commit;
};

// Nothing where no readable commit stands at `offset`. Of `opened`, head, uuid and size are known.
[[nodiscard]] inline std::optional<FoundCommit> commit_at(const File& file, const Opened& opened,
                                                          std::uint64_t offset) {
  FrameResult result = read_frame(file, opened.file_size, offset, &opened.uuid);
  if (result.state != FrameState::whole) return std::nullopt;
  try {
    Commit commit = decode_commit(result.frame, opened.head.tables.size());
    return FoundCommit{std::move(result.frame), std::move(commit)};
  } catch (const Error&) {
    return std::nullopt;
  }
}

// Calls visit(frame) for the valid frames from `offset` on, in order; behind what is no frame, looks
// at every page. Throws Error{bad_input} that names the file for a frame that must not be skipped.
template <class Visit>
void hop(const File& file, const Opened& opened, std::uint64_t offset, const Visit& visit) {
  while (offset < opened.file_size) {
    FrameResult result = read_frame(file, opened.file_size, offset, &opened.uuid);
    if (result.state != FrameState::whole) {
      offset += kPage;
      continue;
    }
    try {
      check_skippable(result.frame.prefix, opened.head);
    } catch (const Error& error) {
      throw Error(ErrorCode::bad_input, file.path() + ": " + error.what());
    }
    offset = result.frame.end();
    visit(result.frame);
  }
}

}  // namespace psf::formats
