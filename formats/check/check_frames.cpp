#include "formats/check/check_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "core/error.h"
#include "formats/layout/chunk.h"
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
      : file_(file), walk_(walk), report_(report) {}

  void run() {
    check_head();
    check_slot();
    check_commits();
    check_chunks();
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
      drop_region(place);
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
    return found != walk_.commits.end() && found->frame.prefix.offset == commit.base &&
           found->commit.chunks == commit.first_chunk;
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
      merge_index(walked, 0, decode_index(*index));
    }
    for (std::size_t k = 0; k < commit.tables.size(); ++k) {
      merge_index(walked, k + 1, commit.tables[k].index);
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

  void merge_index(const WalkedCommit& walked, std::size_t table,
                   const std::vector<ChunkEntry>& entries) {
    const Head& head = walk_.head.head;
    for (const ChunkEntry& entry : entries) {
      const auto [found, inserted] =
          walk_.chunks.try_emplace(entry.offset, WalkedChunk{table, entry, false});
      const WalkedChunk& other = found->second;
      if (inserted || (other.entry == entry && other.table == table)) continue;
      add(walked.frame.prefix,
          fmt::format("its index says {} where the chunk at byte {} says {}",
                      table_range(head, table, entry.first, entry.count), entry.offset,
                      table_range(head, other.table, other.entry.first, other.entry.count)));
    }
  }

  // What was found of a table up to a place in the file.
  struct Found {
    std::uint64_t records = 0, chunks = 0, passes = 0;
  };

  // Every record once, in order; totals of every commit.
  void check_chunks() {
    std::vector<Found> found(walk_.head.head.table_count());
    auto commit = walk_.commits.begin();
    const auto pass_commits = [&](std::uint64_t until) {
      for (; commit != walk_.commits.end() && commit->frame.prefix.offset < until; ++commit) {
        check_totals(*commit, found);
      }
    };
    for (const auto& [offset, chunk] : walk_.chunks) {
      pass_commits(offset);
      const std::uint64_t passes =
          commit == walk_.commits.end() ? std::uint64_t{1} << 32 : commit->commit.passes;
      check_place(chunk, found[chunk.table], passes);
      if (!chunk.readable) add_unreadable(chunk, found[chunk.table]);
      Found& of = found[chunk.table];
      of.records = chunk.entry.first + chunk.entry.count;
      of.passes = chunk.entry.pass + std::uint64_t{1};
      ++of.chunks;
    }
    pass_commits(walk_.end);
  }

  void check_totals(const WalkedCommit& walked, const std::vector<Found>& found) {
    const Commit& told = walked.commit;
    for (std::size_t k = 0; k < found.size(); ++k) {
      const Found& of = found[k];
      const std::uint64_t records = told.records_of(k), chunks = told.chunks_of(k);
      const bool passes = k > 0 || told.passes == of.passes;
      if (records == of.records && chunks == of.chunks && passes) continue;
      add_fault(
          k, {walked.frame.prefix.offset,
              "CMIT",
              {},
              {},
              of.records,
              records > of.records ? records - of.records : 0,
              fmt::format("its totals are {} records, {} chunks, {} passes; found are {}, {}, {}",
                          records, chunks, told.passes, of.records, of.chunks, of.passes)});
    }
  }

  // `passes`: those of the next commit. A pass may be without records of a table.
  void check_place(const WalkedChunk& chunk, const Found& before, std::uint64_t passes) {
    const ChunkEntry& entry = chunk.entry;
    const std::uint64_t next = entry.pass + std::uint64_t{1};
    const bool in_pass = chunk.table == 0 ? entry.pass == before.passes || next == before.passes
                                          : next >= before.passes && next <= passes;
    if (entry.first == before.records && in_pass) return;
    add_fault(chunk.table,
              {entry.offset,
               chunk_type(chunk),
               before.chunks,
               {},
               before.records,
               entry.first > before.records ? entry.first - before.records : 0,
               fmt::format("it holds {} of pass {}; expected are records from {} on, pass {}",
                           record_range(entry.first, entry.count), entry.pass, before.records,
                           chunk.table == 0 ? before.passes : passes - 1)});
  }

  void add_unreadable(const WalkedChunk& chunk, const Found& before) {
    const ChunkEntry& entry = chunk.entry;
    const FrameResult result = read_frame(file_, walk_.file_size, entry.offset, &walk_.uuid());
    add_fault(chunk.table, {entry.offset,
                            chunk_type(chunk),
                            before.chunks,
                            {},
                            entry.first,
                            entry.count,
                            result.fault.empty() ? "its directory is wrong" : result.fault});
    drop_region(entry.offset);
  }

  [[nodiscard]] static std::string chunk_type(const WalkedChunk& chunk) {
    return type_name(chunk.table == 0 ? kChunkType : kTableChunkType);
  }

  void add_fault(std::size_t table, Fault fault) {
    if (table > 0) fault.table = walk_.head.head.table_name(table);
    report_.faults.push_back(std::move(fault));
  }

  void drop_region(std::uint64_t begin) {
    walk_.bad.erase(std::remove_if(walk_.bad.begin(), walk_.bad.end(),
                                   [&](const Region& region) { return region.begin == begin; }),
                    walk_.bad.end());
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
