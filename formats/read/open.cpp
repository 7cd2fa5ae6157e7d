#include "formats/read/open.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"
#include "formats/layout/chunk.h"
#include "formats/layout/head_frame.h"
#include "formats/layout/layout.h"
#include "formats/layout/slot.h"
#include "formats/read/frames.h"
#include "formats/read/index.h"

namespace psf::formats {
namespace {

constexpr int kAttempts = 4;

[[noreturn]] void fail(const File& file, const std::string& why) {
  throw Error(ErrorCode::bad_input, fmt::format("{}: {}", file.path(), why));
}

class Opening {
 public:
  explicit Opening(const File& file) : file_(file) { out_.file_size = file.size(); }

  Opened run() {
    HeadFrame head = read_head(file_, out_.file_size);
    head_end_ = head.frame.end();
    out_.head = std::move(head.head);
    out_.uuid = head.frame.prefix.uuid;
    out_.head_frame = std::move(head.frame);
    find_last_commit();
    out_.commit = last_->commit;
    out_.last = std::move(last_->frame);
    if (out_.commit.foreign_required > 0) {
      fail(file_, fmt::format("written by version {}.{} of the format, with frames that must be "
                              "understood to read it; use a newer program",
                              out_.head.major, out_.head.minor));
    }
    load_index(file_, out_);
    return std::move(out_);
  }

 private:
  void find_last_commit() {
    std::uint64_t promised = 0;  // sequence number of a commit that must be there
    std::uint64_t promised_at = 0;
    for (const SlotRecord& record : read_slot(file_, out_.file_size, head_end_, out_.uuid)) {
      // A file that was cut, or a record of the future: no promise.
      if (record.offset > out_.file_size || record.length > out_.file_size - record.offset)
        continue;
      last_ = commit_at(file_, out_, record.offset);
      if (last_ && last_->frame.prefix.sequence == record.sequence) break;
      last_.reset();
      if (record.sequence > promised) {
        promised = record.sequence;
        promised_at = record.offset;
      }
    }
    hop(file_, out_, last_ ? last_->frame.end() : head_end_, [this](Frame& frame) {
      if (frame.prefix.type != kCommitType) return;
      try {
        Commit commit = decode_commit(frame, out_.head.tables.size());
        last_ = FoundCommit{std::move(frame), std::move(commit)};
      } catch (const Error&) {
        // A later commit tells what is missing; without one, the slot does.
      }
    });
    if (promised > 0 && (!last_ || last_->frame.prefix.sequence < promised)) {
      fail(file_,
           fmt::format("damaged: the commit at byte {} is unreadable, so the records from {} "
                       "on are lost; 'psf verify' names every fault, 'psf recover' saves the rest",
                       promised_at, last_ ? last_->commit.records : 0));
    }
    if (!last_) {
      fail(file_, "holds no committed pass: its writer was stopped before the first; render again");
    }
  }

  const File& file_;
  Opened out_;
  std::uint64_t head_end_ = 0;
  std::optional<FoundCommit> last_;
};

}  // namespace

void check_skippable(const Prefix& prefix, const Head& head) {
  const bool known = prefix.type == kHeadType || prefix.type == kSlotType ||
                     is_chunk(prefix.type, head) || prefix.type == kCommitType;
  if (known || (prefix.flags & kRequiredFrame) == 0) return;
  throw Error(ErrorCode::bad_input,
              fmt::format("written by version {}.{} of the format, with a frame {} at byte {} that "
                          "must be understood to read it; use a newer program",
                          head.major, head.minor, type_name(prefix.type), prefix.offset));
}

HeadFrame read_head(const File& file, std::uint64_t file_size) {
  FrameResult result = read_frame(file, file_size, 0, nullptr);
  if (result.state != FrameState::whole) {
    std::array<std::byte, kMagic.size()> start{};
    if (file_size >= start.size()) file.read_at(0, start);
    if (std::memcmp(start.data(), kMagic.data(), kMagic.size()) != 0) {
      fail(file,
           "is no path-vertex buffer; give the name of a .pvb file (or, where this was one, 'psf "
           "recover' finds a copy of its header)");
    }
    fail(file, fmt::format("its header cannot be read: {}; 'psf recover' finds a "
                           "copy of it",
                           result.fault));
  }
  if (result.frame.prefix.type != kHeadType || result.frame.prefix.sequence != 0) {
    fail(file, "starts with a frame that is not HEAD; it is no path-vertex buffer");
  }
  try {
    Head head = decode_head(result.frame.directory);
    return {std::move(result.frame), std::move(head)};
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("{}: {}", file.path(), error.what()));
  }
}

Opened open_buffer(const File& file) {
  for (int attempt = 1;; ++attempt) {
    const std::uint64_t size = file.size();
    try {
      return Opening(file).run();
    } catch (const Error& error) {
      // A writer that goes on cuts off what was uncommitted, and it may be what was just read.
      const bool changed = error.code() == ErrorCode::io || file.size() != size ||
                           File::is_being_written(file.path());
      if (!changed || attempt == kAttempts) throw;
    }
  }
}

}  // namespace psf::formats
