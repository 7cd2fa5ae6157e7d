#include "formats/read/index.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "formats/layout/chunk.h"
#include "formats/layout/layout.h"
#include "formats/read/frames.h"

namespace psf::formats {
namespace {

ChunkEntry entry_of(const Frame& frame, const Chunk& chunk) {
  return {frame.prefix.offset, frame.prefix.length, chunk.first, chunk.count, chunk.pass};
}

std::vector<std::uint64_t> chunks_up_to(const Commit& commit) {
  std::vector<std::uint64_t> chunks = {commit.chunks};
  for (const TableTotals& table : commit.tables) chunks.push_back(table.chunks);
  return chunks;
}

class IndexLoader {
 public:
  IndexLoader(const File& file, Opened& out) : file_(file), out_(out) {}

  // The index of the last commit and of the commits that it builds on. False where one is
  // unreadable.
  bool load() {
    std::vector<std::vector<ChunkEntry>> paths;  // from the last commit to the first
    std::vector<std::vector<TableTotals>> tables;
    FoundCommit at{out_.last, out_.commit};
    for (;;) {
      try {
        paths.push_back(decode_index(read_section(file_, at.frame, at.commit.index)));
      } catch (const Error& error) {
        if (error.code() == ErrorCode::io) throw;
        return false;
      }
      tables.push_back(std::move(at.commit.tables));
      if (at.commit.first_chunk == 0) {
        out_.root = at.frame.prefix.offset;
        at.commit.tables = tables.back();
        out_.root_chunks = chunks_up_to(at.commit);
        break;
      }
      auto base = commit_at(file_, out_, at.commit.base);
      if (!base || base->commit.chunks != at.commit.first_chunk ||
          !continues(base->commit.tables, tables.back())) {
        return false;
      }
      at = std::move(*base);
    }
    out_.chunks.assign(out_.head.table_count(), {});
    for (std::size_t part = paths.size(); part-- > 0;) {
      append(paths[part], out_.chunks[0]);
      for (std::size_t k = 0; k < tables[part].size(); ++k) {
        append(tables[part][k].index, out_.chunks[k + 1]);
      }
    }
    return is_complete();
  }

  // A commit of the chain is damaged: puts the index together from all frames that are readable.
  void scan() {
    std::vector<std::map<std::uint64_t, ChunkEntry>> by_record(out_.head.table_count());
    hop(file_, out_, out_.head_frame.end(), [&](Frame& frame) { collect(frame, by_record); });
    out_.chunks.assign(by_record.size(), {});
    out_.root = 0;
    std::string missing;
    for (std::size_t k = 0; k < by_record.size(); ++k) {
      missing += take_records(by_record[k], k);
    }
    if (!missing.empty()) {
      missing.pop_back();
      fail(
          fmt::format("damaged: cannot be found:{}; 'psf verify' names every fault, 'psf "
                      "recover' saves the rest",
                      missing));
    }
    if (!is_complete()) {
      fail(fmt::format(
          "damaged: the totals of the commit at byte {} ({} records, {} chunks, "
          "{} passes) do not add up; 'psf verify' names every fault, 'psf recover' "
          "saves the rest",
          out_.last.prefix.offset, out_.commit.records, out_.commit.chunks, out_.commit.passes));
    }
  }

 private:
  // Whether the indices of tables begin where those of the base end.
  [[nodiscard]] static bool continues(const std::vector<TableTotals>& base,
                                      const std::vector<TableTotals>& tables) {
    return std::ranges::equal(base, tables, {}, &TableTotals::chunks, &TableTotals::first_chunk);
  }

  static void append(const std::vector<ChunkEntry>& from, std::vector<ChunkEntry>& to) {
    to.insert(to.end(), from.begin(), from.end());
  }

  [[nodiscard]] bool is_complete() const {
    for (std::size_t k = 0; k < out_.chunks.size(); ++k) {
      if (!is_complete(k)) return false;
    }
    return true;
  }

  // Whether the chunks of a table hold every record up to the last commit, and lie one behind the
  // other. A pass may be without records of a table, but not without paths.
  [[nodiscard]] bool is_complete(std::size_t table) const {
    std::uint64_t record = 0, place = out_.head_frame.end(), passes = 0;
    for (const ChunkEntry& entry : out_.chunks[table]) {
      const std::uint64_t pass = entry.pass;
      if (entry.first != record || entry.count < 1 ||
          entry.count > out_.head.schema(table).chunk_capacity || entry.offset < place ||
          entry.offset % kPage != 0 || entry.offset > out_.last.prefix.offset ||
          entry.length > out_.last.prefix.offset - entry.offset || entry.length < kPage ||
          pass + 1 < passes || (table == 0 && pass > passes)) {
        return false;
      }
      record += entry.count;
      place = entry.offset + entry.length;
      passes = pass + 1;
    }
    const bool all_passes =
        table == 0 ? passes == out_.commit.passes : passes <= out_.commit.passes;
    return record == out_.commit.records_of(table) &&
           out_.chunks[table].size() == out_.commit.chunks_of(table) && all_passes;
  }

  // What a frame says of chunks.
  void collect(const Frame& frame,
               std::vector<std::map<std::uint64_t, ChunkEntry>>& by_record) const {
    try {
      if (is_chunk(frame.prefix.type, out_.head)) {
        const Chunk chunk = decode_chunk(frame, out_.head);
        by_record[chunk.table].emplace(chunk.first, entry_of(frame, chunk));
      } else if (frame.prefix.type == kCommitType) {
        const Commit commit = decode_commit(frame, out_.head.tables.size());
        for (std::size_t k = 0; k < commit.tables.size(); ++k) {
          for (const ChunkEntry& entry : commit.tables[k].index) {
            by_record[k + 1].emplace(entry.first, entry);
          }
        }
        for (const ChunkEntry& entry : decode_index(read_section(file_, frame, commit.index))) {
          by_record[0].emplace(entry.first, entry);
        }
      }
    } catch (const Error& error) {
      if (error.code() == ErrorCode::io) throw;
    }
  }

  // Takes the chunks of a table up to the last commit. Returns what is missing as text.
  std::string take_records(const std::map<std::uint64_t, ChunkEntry>& by_record,
                           std::size_t table) {
    const std::uint64_t records = out_.commit.records_of(table);
    std::uint64_t next = 0;
    std::string missing;
    const auto miss = [&](std::uint64_t until) {
      if (until <= next) return;
      missing += " " + table_range(out_.head, table, next, until - next) + ",";
    };
    for (const auto& [first, entry] : by_record) {
      if (first >= records) break;
      miss(first);
      next = std::max(next, first + entry.count);
      out_.chunks[table].push_back(entry);
    }
    miss(records);
    return missing;
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw Error(ErrorCode::bad_input, fmt::format("{}: {}", file_.path(), why));
  }

  const File& file_;
  Opened& out_;
};

}  // namespace

void load_index(const File& file, Opened& opened) {
  IndexLoader loader(file, opened);
  if (!loader.load()) loader.scan();
}

}  // namespace psf::formats
