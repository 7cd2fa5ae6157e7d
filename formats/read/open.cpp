#include "formats/read/open.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"
#include "formats/layout/chunk.h"
#include "formats/layout/head_frame.h"
#include "formats/layout/layout.h"
#include "formats/layout/slot.h"

namespace psf::formats {
namespace {

constexpr int kAttempts = 4;

[[noreturn]] void fail(const File& file, const std::string& why) {
  throw Error(ErrorCode::bad_input, fmt::format("{}: {}", file.path(), why));
}

struct FoundCommit {
  Frame frame;
  Commit commit;
};

ChunkEntry entry_of(const Frame& frame, const Chunk& chunk) {
  return {frame.prefix.offset, frame.prefix.length, chunk.first, chunk.count, chunk.pass};
}

std::vector<std::uint64_t> chunks_up_to(const Commit& commit) {
  std::vector<std::uint64_t> chunks = {commit.chunks};
  for (const TableTotals& table : commit.tables) chunks.push_back(table.chunks);
  return chunks;
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
    if (!load_index()) scan_index();
    return std::move(out_);
  }

 private:
  [[nodiscard]] FrameResult frame_at(std::uint64_t offset) const {
    return read_frame(file_, out_.file_size, offset, &out_.uuid);
  }

  // Nothing where no readable commit stands at `offset`.
  [[nodiscard]] std::optional<FoundCommit> commit_at(std::uint64_t offset) const {
    FrameResult result = frame_at(offset);
    if (result.state != FrameState::whole) return std::nullopt;
    try {
      Commit commit = decode_commit(result.frame, out_.head.tables.size());
      return FoundCommit{std::move(result.frame), std::move(commit)};
    } catch (const Error&) {
      return std::nullopt;
    }
  }

  void find_last_commit() {
    std::uint64_t promised = 0;  // sequence number of a commit that must be there
    std::uint64_t promised_at = 0;
    for (const SlotRecord& record : read_slot(file_, out_.file_size, head_end_, out_.uuid)) {
      // A file that was cut, or a record of the future: no promise.
      if (record.offset > out_.file_size || record.length > out_.file_size - record.offset)
        continue;
      last_ = commit_at(record.offset);
      if (last_ && last_->frame.prefix.sequence == record.sequence) break;
      last_.reset();
      if (record.sequence > promised) {
        promised = record.sequence;
        promised_at = record.offset;
      }
    }
    hop(last_ ? last_->frame.end() : head_end_, [this](Frame& frame) {
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

  // Visits the valid frames from `offset` on, in order; behind what is no frame, looks at every
  // page.
  template <class Visit>
  void hop(std::uint64_t offset, const Visit& visit) const {
    while (offset < out_.file_size) {
      FrameResult result = frame_at(offset);
      if (result.state != FrameState::whole) {
        offset += kPage;
        continue;
      }
      check(result.frame.prefix);
      offset = result.frame.end();
      visit(result.frame);
    }
  }

  void check(const Prefix& prefix) const {
    try {
      check_skippable(prefix, out_.head);
    } catch (const Error& error) {
      fail(file_, error.what());
    }
  }

  // The index of the last commit and of the commits that it builds on. False where one is
  // unreadable.
  bool load_index() {
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
      auto base = commit_at(at.commit.base);
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
    std::uint64_t record = 0, place = head_end_, passes = 0;
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

  // A commit of the chain is damaged: puts the index together from all frames that are readable.
  void scan_index() {
    std::vector<std::map<std::uint64_t, ChunkEntry>> by_record(out_.head.table_count());
    hop(head_end_, [&](Frame& frame) { collect(frame, by_record); });
    out_.chunks.assign(by_record.size(), {});
    out_.root = 0;
    std::string missing;
    for (std::size_t k = 0; k < by_record.size(); ++k) {
      missing += take_records(by_record[k], k);
    }
    if (!missing.empty()) {
      missing.pop_back();
      fail(file_, fmt::format("damaged: cannot be found:{}; 'psf verify' names every fault, 'psf "
                              "recover' saves the rest",
                              missing));
    }
    if (!is_complete()) {
      fail(file_,
           fmt::format("damaged: the totals of the commit at byte {} ({} records, {} chunks, "
                       "{} passes) do not add up; 'psf verify' names every fault, 'psf recover' "
                       "saves the rest",
                       out_.last.prefix.offset, out_.commit.records, out_.commit.chunks,
                       out_.commit.passes));
    }
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
