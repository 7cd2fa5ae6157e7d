#include "formats/check/restore_head.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "formats/layout/bytes.h"
#include "formats/layout/commit.h"
#include "formats/layout/frame.h"
#include "formats/layout/head_frame.h"
#include "formats/layout/layout.h"

namespace psf::formats {
namespace {

// What stood at the start of the file, from the section of a commit; throws Error where it is none.
HeadFrame head_of(const File& file, const Frame& frame) {
  const std::vector<std::byte> copy = read_section(file, frame, decode_commit(frame, 0).head);
  if (copy.size() < kPrefix) throw Error(ErrorCode::bad_input, "too short");
  HeadFrame result;
  Prefix& prefix = result.frame.prefix;
  result.frame.directory.assign(copy.begin() + kPrefix, copy.end());
  ByteReader in(copy);
  in.skip(28);
  prefix.flags = in.get<std::uint32_t>();
  in.skip(8);
  prefix.length = in.get<std::uint64_t>();
  prefix.uuid = frame.prefix.uuid;
  prefix.type = kHeadType;
  // All else is what HEAD must say, the checksum included.
  if (!std::ranges::equal(encode_front(prefix, result.frame.directory), copy)) {
    throw Error(ErrorCode::bad_input, "no copy of HEAD");
  }
  result.head = decode_head(result.frame.directory);
  return result;
}

}  // namespace

std::optional<HeadFrame> restore_head(const File& file, std::uint64_t file_size) {
  for (std::uint64_t offset = kPage; offset < file_size;) {
    const FrameResult result = read_frame(file, file_size, offset, nullptr);
    if (result.state != FrameState::whole) {
      offset += kPage;
      continue;
    }
    offset = result.frame.end();
    if (result.frame.prefix.type != kCommitType) continue;
    try {
      return head_of(file, result.frame);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::io) throw;
    }
  }
  return std::nullopt;
}

}  // namespace psf::formats
