#include "formats/check/recover.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "core/error.h"
#include "formats/check/check_frames.h"
#include "formats/check/column_reader.h"
#include "formats/check/restore_head.h"
#include "formats/check/table_recovery.h"
#include "formats/check/walk.h"
#include "formats/layout/chunk.h"
#include "formats/layout/file.h"
#include "formats/layout/layout.h"
#include "formats/layout/metadata.h"
#include "formats/layout/slot.h"
#include "formats/read/open.h"
#include "formats/write/appender.h"

namespace psf::formats {
namespace {

[[noreturn]] void refuse_recovery(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::bad_input, fmt::format("{}: nothing can be saved: {}", path, why));
}

void check_other_file(const std::string& in, const std::string& out) {
  for (const std::string& name : {out, Appender::partial_path(out)}) {
    std::error_code missing;
    if (!std::filesystem::equivalent(in, name, missing)) continue;
    throw Error(ErrorCode::usage,
                fmt::format("{}: writing it would overwrite {}, the damaged file itself; give "
                            "another name",
                            out, name));
  }
}

class Recovery {
 public:
  Recovery(const std::string& in, const std::string& out, const RecoverOptions& options)
      : file_(File::open(in)), out_(out), options_(options) {
    check_other_file(in, out);
    find_head();
  }

  RecoverResult run(const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
    walk_ = walk_frames(file_, std::move(head_));
    committed_ = committed_end();
    limit_ = options_.uncommitted ? walk_.file_size : std::min(committed_, walk_.file_size);
    drop_behind(walk_, limit_);
    check_all_frames();
    check_metadata();
    appender_ = Appender::create(out_, walk_.head.head, {}, Appender::Appear::published);
    copy_chunks(progress);
    finish();
    report_.uncommitted_bytes = walk_.file_size - limit_;
    return std::move(report_);
  }

 private:
  void find_head() {
    const std::uint64_t size = file_.size();
    const FrameResult result = read_frame(file_, size, 0, nullptr);
    if (result.state == FrameState::whole) {
      head_ = read_head(file_, size);  // what it refuses cannot be helped by a copy
      return;
    }
    std::optional<HeadFrame> found = restore_head(file_, size);
    if (!found) refuse_recovery(file_.path(), result.fault + ", and no commit has a copy of HEAD");
    head_ = std::move(*found);
    report_.head_restored = true;
    report_.faults.push_back({0, "HEAD", {}, {}, 0, 0, result.fault});
  }

  // Where what was committed ends: behind the last commit, or where the slot says that a later one
  // stood, be it past the end of a file that was cut.
  [[nodiscard]] std::uint64_t committed_end() const {
    std::uint64_t end = walk_.end;
    for (const SlotRecord& record : later_commits()) end = std::max(end, record.offset);
    return end;
  }
  // What the slot tells of commits behind the last that was found.
  [[nodiscard]] std::vector<SlotRecord> later_commits() const {
    const std::uint64_t known =
        walk_.commits.empty() ? 0 : walk_.commits.back().frame.prefix.sequence;
    std::vector<SlotRecord> later =
        read_slot(file_, walk_.file_size, walk_.head.frame.end(), walk_.uuid());
    std::erase_if(later, [known](const SlotRecord& record) { return record.sequence <= known; });
    return later;
  }

  void check_all_frames() {
    CheckResult frames;
    check_frames(file_, walk_, frames);
    report_.faults.insert(report_.faults.end(), frames.faults.begin(), frames.faults.end());
    report_.faults.insert(report_.faults.end(), walk_.faults.begin(), walk_.faults.end());
  }

  // A writer that knows no JSON: the records are worth saving all the same.
  void check_metadata() {
    std::string& metadata = walk_.head.head.metadata;
    try {
      static_cast<void>(parse_metadata(metadata));
    } catch (const Error& error) {
      lose({0, "HEAD", {}, {}, 0, 0, fmt::format("{}; left out", error.what())});
      metadata = "{}";
    }
  }

  void copy_chunks(const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
    ColumnReader reader(file_, walk_);
    TableRecovery tables(walk_, reader, *appender_);
    const auto copy_tables = [&](std::uint32_t of) {
      if (!broken_.contains(of)) report_.chunks_saved += tables.save(of, report_.faults);
    };
    std::uint64_t next = 0, number = 0;  // record, chunk
    std::uint32_t before = 0;            // pass of the chunk before
    // That of the last chunk that was saved, and the same until its tables are.
    std::optional<std::uint32_t> pass, unfinished;
    for (const auto& [offset, walked] : walk_.chunks) {
      if (progress) progress(offset, limit_);
      if (walked.table > 0) continue;
      const ChunkEntry& entry = walked.entry;
      if (entry.first < next || entry.first + entry.count < entry.first) {
        lose({offset, "CHNK", number, {}, entry.first, 0, "its records are those of another"});
        broken_.insert({before, entry.pass});
        continue;
      }
      if (entry.first > next) {
        lose_range(next, entry.first, offset);
        broken_.insert({before, entry.pass});
      }
      next = entry.first + entry.count;
      before = entry.pass;
      if (unfinished && *unfinished != entry.pass) {
        copy_tables(*unfinished);
        unfinished.reset();
      }
      if (!is_saved(walked, number++, reader)) continue;
      if (pass && *pass != entry.pass) appender_->commit({});
      pass = unfinished = entry.pass;
      appender_->add_chunk(0, entry.count, reader.columns());
      ++report_.chunks_saved;
    }
    const std::uint64_t total = walk_.commits.empty() ? 0 : walk_.commits.back().commit.records;
    if (total > next) {
      lose_range(next, total, walk_.end);
      broken_.insert(before);
    }
    if (unfinished) copy_tables(*unfinished);
    for (Fault& loss : tables.losses(broken_, options_.uncommitted)) lose(std::move(loss));
    std::stable_sort(report_.losses.begin(), report_.losses.end(),
                     [](const Fault& x, const Fault& y) { return x.offset < y.offset; });
  }

  // Whether a chunk of the paths, whose columns `reader` then has, can be saved.
  bool is_saved(const WalkedChunk& walked, std::uint64_t number, ColumnReader& reader) {
    const ChunkEntry& entry = walked.entry;
    const std::vector<Fault> faults =
        walked.readable ? reader.read(walked, number) : std::vector<Fault>();
    report_.faults.insert(report_.faults.end(), faults.begin(), faults.end());
    if (walked.readable && faults.empty()) return true;
    broken_.insert(entry.pass);
    lose(walked.readable ? faults.front()
                         : Fault{entry.offset,
                                 "CHNK",
                                 number,
                                 {},
                                 entry.first,
                                 entry.count,
                                 "its frame cannot be read"});
    return false;
  }

  void lose_range(std::uint64_t first, std::uint64_t last, std::uint64_t before) {
    lose({before, "", {}, {}, first, last - first, "nothing of them can be found before here"});
  }

  void lose(Fault fault) {
    if (fault.table.empty()) report_.records_lost += fault.records;
    report_.losses.push_back(std::move(fault));
  }

  // Between the last readable commit and a later one there may have been more than was found.
  void check_end() {
    // A reader that trusts the slot finds it, and may find more in it than was found here.
    for (const SlotRecord& record : later_commits()) {
      if (record.offset >= walk_.end) continue;
      lose({record.offset, "CMIT", {}, {}, 0, 0, "another frame is said to reach over it"});
    }
    if (committed_ <= walk_.end) return check_slot();
    std::uint64_t place = std::max(walk_.end, walk_.head.frame.end());
    for (const Prefix& frame : walk_.frames) {
      if (frame.offset == place) place += frame.length;
    }
    if (place < committed_) {
      lose({place, "", {}, {}, 0, 0, "a pass was committed behind here and is not whole"});
    }
  }

  // The slot tells the last commit. Where it does not, and something lies behind the last that was
  // found, a later one may have been destroyed together with the slot.
  void check_slot() {
    if (walk_.file_size <= std::max(walk_.end, walk_.head.frame.end() + kPage)) return;
    const std::uint64_t place = walk_.head.frame.end();
    if (walk_.commits.empty() && is_unwritten_slot(file_, walk_.file_size, place, walk_.uuid())) {
      return;
    }
    const std::uint64_t known =
        walk_.commits.empty() ? 0 : walk_.commits.back().frame.prefix.sequence;
    const auto records = read_slot(file_, walk_.file_size, place, walk_.uuid());
    if (known > 0 && !records.empty() && records.front().sequence >= known) return;
    lose({place,
          "SLOT",
          {},
          {},
          0,
          0,
          fmt::format("it does not tell whether a pass was committed behind byte {}", walk_.end)});
  }

  void finish() {
    if (report_.chunks_saved == 0) {
      refuse_recovery(file_.path(),
                      options_.uncommitted || walk_.file_size == limit_
                          ? "no chunk is whole"
                          : "no chunk of a finished pass is whole; --uncommitted takes the "
                            "others, too");
    }
    check_end();
    appender_->commit(resume_state());
    appender_->close();
    check_output();
    appender_->publish();
    report_.records_saved = appender_->records();
    report_.passes_saved = appender_->passes();
  }

  // The resume state to keep; empty where records are lost, since it would then be wrong.
  std::vector<std::byte> resume_state() {
    if (!report_.losses.empty() || walk_.commits.empty()) return {};
    const WalkedCommit& last = walk_.commits.back();
    if (last.commit.records != appender_->appended()) return {};
    try {
      return read_section(file_, last.frame, last.commit.resume);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::io) throw;
      lose({last.frame.prefix.offset, "CMIT", {}, {}, 0, 0, "its resume state cannot be read"});
      return {};
    }
  }

  void check_output() const {
    const CheckResult output = check(appender_->current_path());
    if (output.faults.empty() && output.records == appender_->records()) return;
    throw Error(ErrorCode::io,
                fmt::format("{}: what was written reads back otherwise{}; check the disk", out_,
                            output.faults.empty() ? "" : ": " + output.faults.front().text()));
  }

  File file_;
  std::string out_;
  RecoverOptions options_;
  HeadFrame head_;
  Walk walk_;
  std::uint64_t committed_ = 0;  // see committed_end()
  std::uint64_t limit_ = 0;      // what lies from here on is not taken
  std::unique_ptr<Appender> appender_;
  std::set<std::uint32_t> broken_;  // passes of which paths are lost
  RecoverResult report_;
};

}  // namespace

RecoverResult recover(const std::string& in, const std::string& out, const RecoverOptions& options,
                      const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  RecoverResult report = Recovery(in, out, options).run(progress);
  std::stable_sort(report.faults.begin(), report.faults.end(),
                   [](const Fault& a, const Fault& b) { return a.offset < b.offset; });
  return report;
}

}  // namespace psf::formats
