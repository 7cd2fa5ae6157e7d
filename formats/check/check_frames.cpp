#include "formats/check/check_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "core/error.h"
#include "formats/check/check_chunks.h"
#include "formats/layout/head_frame.h"
#include "formats/layout/layout.h"
#include "formats/layout/metadata.h"
#include "formats/layout/slot.h"

namespace psf::formats {
namespace {

bool is_zero(std::byte value) {
  return value == std::byte{0};
}

class FrameCheck {
 public:
  FrameCheck(const File& file, Walk& walk, CheckResult& report)
      : file_(file), walk_(walk), report_(report), chunks_(file, walk, report) {}

  void run() {
    check_head();
    check_slot();
    check_commits();
    chunks_.check();
    add_bad_regions();
  }

 private:
  void add(const Prefix& frame, std::string message) {
    report_.faults.push_back(
        {frame.offset, type_name(frame.type), {}, {}, 0, 0, std::move(message)});
  }

  void check_head() {
    const Frame& frame = walk_.head.frame;
    check_zeros(file_, frame.prefix, kPrefix + frame.directory.size(), frame.prefix.length,
                report_);
    try {
      static_cast<void>(parse_metadata(walk_.head.head.metadata));
    } catch (const Error& error) {
      add(frame.prefix, error.what());
    }
  }

  void check_slot() {
    const std::uint64_t place = walk_.head.frame.end();
    const auto slot = std::find_if(
        walk_.frames.begin(), walk_.frames.end(),
        [&](const Prefix& prefix) { return prefix.offset == place && prefix.type == kSlotType; });
    if (slot == walk_.frames.end()) {
      report_.faults.push_back({place, "SLOT", {}, {}, 0, 0, "it cannot be read"});
      drop_region(walk_, place);
      return;
    }
    check_zeros(file_, *slot, kPrefix, kSlotFirst, report_);
    check_zeros(file_, *slot, kSlotFirst + kSlotRecord, kSlotSecond, report_);
    check_zeros(file_, *slot, kSlotSecond + kSlotRecord, slot->length, report_);
    for (const std::size_t at : {kSlotFirst, kSlotSecond}) check_slot_record(*slot, at);
  }

  void check_slot_record(const Prefix& slot, std::size_t at) {
    std::array<std::byte, kSlotRecord> bytes;
    file_.read_at(slot.offset + at, bytes);
    if (std::all_of(bytes.begin(), bytes.end(), is_zero)) return;  // not written yet
    const auto record = decode_slot_record(bytes);
    if (!record) return add(slot, fmt::format("the checksum of its record at {} is wrong", at));
    const auto named = std::find_if(
        walk_.commits.begin(), walk_.commits.end(),
        [&](const WalkedCommit& c) { return c.frame.prefix.offset == record->offset; });
    if (named != walk_.commits.end() && named->frame.prefix.sequence == record->sequence &&
        named->frame.prefix.length == record->length) {
      return;
    }
    const bool cut =
        record->offset > walk_.file_size || record->length > walk_.file_size - record->offset;
    add(slot, fmt::format("the commit that it names, at byte {}, {}", record->offset,
                          cut ? "is missing: the file was cut" : "cannot be read"));
    if (!cut) commit_places_.insert(record->offset);
  }

  void check_commits() {
    const WalkedCommit* before = nullptr;
    for (const WalkedCommit& walked : walk_.commits) {
      const Prefix& prefix = walked.frame.prefix;
      const Commit& commit = walked.commit;
      check_sections(walked);
      const std::uint64_t previous = before == nullptr ? 0 : before->frame.prefix.offset;
      const std::uint64_t number = before == nullptr ? 1 : before->commit.number + 1;
      if (commit.previous != previous || commit.number != number) {
        commit_places_.insert(commit.previous);
        add(prefix, fmt::format("it is commit {} and names the one before at byte {}; expected {} "
                                "and {}",
                                commit.number, commit.previous, number, previous));
      }
      if (commit.base > 0 && !is_base(commit)) {
        commit_places_.insert(commit.base);
        add(prefix, fmt::format("the commit at byte {} that its index continues cannot be read or "
                                "does not fit",
                                commit.base));
      }
      before = &walked;
    }
  }

  // Whether a commit that was found is what the index of this one continues.
  [[nodiscard]] bool is_base(const Commit& commit) const {
    const auto found = std::lower_bound(walk_.commits.begin(), walk_.commits.end(), commit.base,
                                        [](const WalkedCommit& other, std::uint64_t offset) {
                                          return other.frame.prefix.offset < offset;
                                        });
    if (found == walk_.commits.end() || found->frame.prefix.offset != commit.base) return false;
    for (std::size_t table = 0; table < walk_.head.head.table_count(); ++table) {
      if (found->commit.chunks_of(table) != commit.first_chunk_of(table)) return false;
    }
    return true;
  }

  void check_sections(const WalkedCommit& walked) {
    const Commit& commit = walked.commit;
    const Prefix& prefix = walked.frame.prefix;
    std::uint64_t place = kPrefix + walked.frame.directory.size();
    for (const Section* section : {&commit.index, &commit.head, &commit.resume}) {
      check_zeros(file_, prefix, place, section->offset, report_);
      place = std::max(place, section->offset + section->length);
    }
    check_zeros(file_, prefix, place, prefix.length, report_);
    if (const auto index = section(walked, commit.index, "index")) {
      chunks_.merge_index(walked, 0, decode_index(*index));
    }
    for (std::size_t k = 0; k < commit.tables.size(); ++k) {
      chunks_.merge_index(walked, k + 1, commit.tables[k].index);
    }
    const auto head = section(walked, commit.head, "copy of HEAD");
    const Frame& original = walk_.head.frame;
    if (head && *head != encode_front(original.prefix, original.directory)) {
      add(prefix, "its copy of HEAD differs from HEAD");
    }
    static_cast<void>(section(walked, commit.resume, "resume state"));
  }

  // Nothing, and a fault, where its checksum is wrong.
  std::optional<std::vector<std::byte>> section(const WalkedCommit& walked, const Section& section,
                                                const char* name) {
    try {
      return read_section(file_, walked.frame, section);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::io) throw;
      add(walked.frame.prefix, fmt::format("the checksum of its {} is wrong", name));
      return std::nullopt;
    }
  }

  void add_bad_regions() {
    for (Region& region : walk_.bad) {
      const bool commit = commit_places_.contains(region.begin);
      report_.faults.push_back(
          {region.begin,
           commit ? "CMIT" : "",
           {},
           {},
           0,
           0,
           fmt::format("{}; {} bytes are skipped", region.fault, region.end - region.begin)});
    }
  }

  const File& file_;
  Walk& walk_;
  CheckResult& report_;
  ChunkCheck chunks_;
  std::set<std::uint64_t> commit_places_;  // where a commit should be but cannot be read
};

}  // namespace

void check_frames(const File& file, Walk& walk, CheckResult& report) {
  FrameCheck(file, walk, report).run();
}

void check_zeros(const File& file, const Prefix& frame, std::uint64_t from, std::uint64_t to,
                 CheckResult& report) {
  if (from >= to) return;
  std::vector<std::byte> bytes(
      static_cast<std::size_t>(std::min<std::uint64_t>(to - from, 1 << 20)));
  for (; from < to; from += bytes.size()) {
    const auto piece = std::span(bytes).first(
        static_cast<std::size_t>(std::min<std::uint64_t>(to - from, bytes.size())));
    file.read_at(frame.offset + from, piece);
    if (std::all_of(piece.begin(), piece.end(), is_zero)) continue;
    report.faults.push_back({frame.offset,
                             type_name(frame.type),
                             {},
                             {},
                             0,
                             0,
                             "its padding is not zero; no value is lost"});
    return;
  }
}

}  // namespace psf::formats
