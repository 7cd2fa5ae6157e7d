#include "formats/check/walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "formats/layout/chunk.h"
#include "formats/layout/layout.h"

namespace psf::formats {
namespace {

void visit(Walk& walk, Frame frame) {
  const Prefix prefix = frame.prefix;
  const auto fail = [&](const char* message) {
    walk.faults.push_back({prefix.offset, type_name(prefix.type), {}, {}, 0, 0, message});
  };
  walk.frames.push_back(prefix);
  check_skippable(prefix, walk.head.head);
  try {
    if (is_chunk(prefix.type, walk.head.head)) {
      const Chunk chunk = decode_chunk(frame, walk.head.head);
      walk.chunks[prefix.offset] = {
          chunk.table, {prefix.offset, prefix.length, chunk.first, chunk.count, chunk.pass}, true};
    } else if (prefix.type == kCommitType) {
      Commit commit = decode_commit(frame, walk.head.head.tables.size());
      walk.commits.push_back({std::move(frame), std::move(commit)});
    } else if (prefix.type == kHeadType) {
      fail("a second HEAD");
    }
  } catch (const Error& error) {
    fail(error.what());
  }
}

void visit_all(const File& file, Walk& walk) {
  std::uint64_t offset = walk.head.frame.end(), sequence = 0;
  bool gap = false;
  while (offset < walk.file_size) {
    FrameResult result = read_frame(file, walk.file_size, offset, &walk.uuid());
    if (result.state != FrameState::whole) {
      if (!gap) walk.bad.push_back({offset, 0, std::move(result.fault)});
      gap = true;
      offset += kPage;
      walk.bad.back().end = std::min(offset, walk.file_size);
      continue;
    }
    const Prefix prefix = result.frame.prefix;
    if (gap ? prefix.sequence <= sequence : prefix.sequence != sequence + 1) {
      walk.faults.push_back({prefix.offset,
                             type_name(prefix.type),
                             {},
                             {},
                             0,
                             0,
                             fmt::format("its sequence number is {} where {} is due",
                                         prefix.sequence, sequence + 1)});
    }
    sequence = prefix.sequence;
    gap = false;
    offset = result.frame.end();
    visit(walk, std::move(result.frame));
  }
}

template <class List, class Offset>
void drop(List& list, std::uint64_t end, const Offset& offset) {
  list.erase(std::remove_if(list.begin(), list.end(),
                            [&](const auto& element) { return offset(element) >= end; }),
             list.end());
}

}  // namespace

Walk walk_frames(const File& file, HeadFrame head) {
  Walk walk;
  walk.file_size = file.size();
  walk.head = std::move(head);
  try {
    visit_all(file, walk);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::io) throw;
    throw Error(error.code(), fmt::format("{}: {}", file.path(), error.what()));
  }
  if (walk.commits.empty()) return walk;
  walk.end = walk.commits.back().frame.end();
  if (walk.commits.back().commit.foreign_required > 0) {  // they were there, and are unreadable
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: written by version {}.{} of the format, with frames that must be "
                            "understood to read it; use a newer program",
                            file.path(), walk.head.head.major, walk.head.head.minor));
  }
  return walk;
}

void drop_region(Walk& walk, std::uint64_t begin) {
  std::erase_if(walk.bad, [&](const Region& region) { return region.begin == begin; });
}

void drop_behind(Walk& walk, std::uint64_t end) {
  drop(walk.frames, end, [](const Prefix& prefix) { return prefix.offset; });
  drop(walk.bad, end, [](const Region& region) { return region.begin; });
  drop(walk.faults, end, [](const Fault& fault) { return fault.offset; });
  drop(walk.commits, end, [](const WalkedCommit& commit) { return commit.frame.prefix.offset; });
  walk.chunks.erase(walk.chunks.lower_bound(end), walk.chunks.end());
}

}  // namespace psf::formats
