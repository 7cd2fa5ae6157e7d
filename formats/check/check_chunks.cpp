#include "formats/check/check_chunks.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "formats/layout/chunk.h"
#include "formats/layout/layout.h"

namespace psf::formats {
namespace {

std::string chunk_type(const WalkedChunk& chunk) {
  return type_name(chunk.table == 0 ? kChunkType : kTableChunkType);
}

}  // namespace

std::string ChunkCheck::text_of(std::size_t table, const ChunkEntry& entry) const {
  return fmt::format("{} of pass {} in {} bytes",
                     table_range(walk_.head.head, table, entry.first, entry.count), entry.pass,
                     entry.length);
}

void ChunkCheck::add_fault(std::size_t table, Fault fault) {
  if (table > 0) fault.table = walk_.head.head.table_name(table);
  report_.faults.push_back(std::move(fault));
}

void ChunkCheck::merge_index(const WalkedCommit& walked, std::size_t table,
                             const std::vector<ChunkEntry>& entries) {
  for (const ChunkEntry& entry : entries) {
    const auto [found, inserted] =
        walk_.chunks.try_emplace(entry.offset, WalkedChunk{table, entry, false});
    const WalkedChunk& other = found->second;
    if (inserted || (other.entry == entry && other.table == table)) continue;
    const Prefix& frame = walked.frame.prefix;
    add_fault(
        0, {frame.offset,
            type_name(frame.type),
            {},
            {},
            0,
            0,
            fmt::format("its index says {} where the chunk at byte {} says {}",
                        text_of(table, entry), entry.offset, text_of(other.table, other.entry))});
  }
}

void ChunkCheck::check() {
  std::vector<Found> found(walk_.head.head.table_count());
  auto commit = walk_.commits.begin();
  const auto pass_commits = [&](std::uint64_t until) {
    for (; commit != walk_.commits.end() && commit->frame.prefix.offset < until; ++commit) {
      check_totals(*commit, found);
    }
  };
  for (const auto& [offset, chunk] : walk_.chunks) {
    pass_commits(offset);
    const Commit* next = commit == walk_.commits.end() ? nullptr : &commit->commit;
    Found& of = found[chunk.table];
    check_place(chunk, of, next);
    if (!chunk.readable) add_unreadable(chunk, of);
    of.records = chunk.entry.first + chunk.entry.count;
    of.passes = chunk.entry.pass + std::uint64_t{1};
    // A pass of a table that cannot be is told once, and not by the chunks behind it.
    if (chunk.table > 0 && next != nullptr) of.passes = std::min(of.passes, next->passes);
    ++of.chunks;
  }
  pass_commits(walk_.end);
}

void ChunkCheck::check_totals(const WalkedCommit& walked, const std::vector<Found>& found) {
  const Commit& told = walked.commit;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Found& of = found[k];
    const std::uint64_t records = told.records_of(k), chunks = told.chunks_of(k);
    const bool passes = k > 0 || told.passes == of.passes;
    if (records == of.records && chunks == of.chunks && passes) continue;
    add_fault(k,
              {walked.frame.prefix.offset,
               type_name(kCommitType),
               {},
               {},
               of.records,
               records > of.records ? records - of.records : 0,
               fmt::format("its totals are {} records, {} chunks, {} passes; found are {}, {}, {}",
                           records, chunks, told.passes, of.records, of.chunks, of.passes)});
  }
}

void ChunkCheck::check_place(const WalkedChunk& chunk, const Found& before, const Commit* next) {
  const ChunkEntry& entry = chunk.entry;
  const std::uint64_t passes = entry.pass + std::uint64_t{1};
  const bool is_path = chunk.table == 0;
  // A pass may be without records of a table.
  const bool in_pass = is_path
                           ? entry.pass == before.passes || passes == before.passes
                           : passes >= before.passes && (next == nullptr || passes <= next->passes);
  if (entry.first == before.records && in_pass) return;
  std::string expected = fmt::format("records from {} on", before.records);
  if (is_path) expected += fmt::format(", pass {}", before.passes);
  if (!is_path && next != nullptr && next->passes > 0)
    expected += fmt::format(", pass {}", next->passes - 1);
  add_fault(chunk.table,
            {entry.offset,
             chunk_type(chunk),
             before.chunks,
             {},
             before.records,
             entry.first > before.records ? entry.first - before.records : 0,
             fmt::format("it holds {} of pass {}; expected are {}",
                         record_range(entry.first, entry.count), entry.pass, expected)});
}

void ChunkCheck::add_unreadable(const WalkedChunk& chunk, const Found& before) {
  const ChunkEntry& entry = chunk.entry;
  const FrameResult result = read_frame(file_, walk_.file_size, entry.offset, &walk_.uuid());
  add_fault(chunk.table, {entry.offset,
                          chunk_type(chunk),
                          before.chunks,
                          {},
                          entry.first,
                          entry.count,
                          result.fault.empty() ? "its directory is wrong" : result.fault});
  drop_region(walk_, entry.offset);
}

}  // namespace psf::formats
