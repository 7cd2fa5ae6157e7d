#include "formats/check/recover.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "core/error.h"
#include "formats/check/check_frames.h"
#include "formats/check/restore_head.h"
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

// Reads the columns of chunks and finds out which are whole.
class ColumnReader {
 public:
  ColumnReader(const File& file, const Walk& walk) : file_(file), walk_(walk) {
    const std::size_t channels = walk.head.head.channels.size();
    columns_.resize(channels);
    stored_.resize(channels);
    decoded_.resize(channels);
  }

  // What is wrong with the columns of a chunk; nothing where columns() has them all.
  std::vector<Fault> read(const ChunkEntry& entry, std::uint64_t number) {
    const Head& head = walk_.head.head;
    const FrameResult result = read_frame(file_, walk_.file_size, entry.offset, &walk_.uuid());
    if (result.state != FrameState::whole) {
      return {{entry.offset, "CHNK", number, {}, entry.first, entry.count, result.fault}};
    }
    const Chunk chunk = decode_chunk(result.frame, head);
    std::vector<std::string> wrong(columns_.size());
    tbb::parallel_for(std::size_t{0}, columns_.size(), [&](std::size_t k) {
      try {
        columns_[k] = read_stored(file_, entry.offset, chunk.columns[k], stored_[k]);
        if (columns_[k].codec == Codec::raw) return;
        const std::size_t size = chunk.count * head.channels[k].stride();
        decode_zstd(columns_[k].bytes, columns_[k].filter, decoded_[k].get(size));
      } catch (const Error& error) {
        if (error.code() == ErrorCode::io) throw;
        wrong[k] = error.what();
      }
    });
    std::vector<Fault> faults;
    for (std::size_t k = 0; k < wrong.size(); ++k) {
      if (wrong[k].empty()) continue;
      faults.push_back({entry.offset, "CHNK", number, head.channels[k].name, entry.first,
                        entry.count, std::move(wrong[k])});
    }
    return faults;
  }

  [[nodiscard]] std::span<const EncodedColumn> columns() const { return columns_; }

 private:
  const File& file_;
  const Walk& walk_;
  std::vector<EncodedColumn> columns_;
  std::vector<Buffer> stored_, decoded_;
};

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
    const std::uint64_t known =
        walk_.commits.empty() ? 0 : walk_.commits.back().frame.prefix.sequence;
    std::uint64_t end = walk_.end;
    for (const SlotRecord& record :
         read_slot(file_, walk_.file_size, walk_.head.frame.end(), walk_.uuid())) {
      if (record.sequence > known) end = std::max(end, record.offset);
    }
    return end;
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
    std::uint64_t next = 0, number = 0;  // record, chunk
    std::optional<std::uint32_t> pass;
    for (const auto& [offset, walked] : walk_.chunks) {
      const ChunkEntry& entry = walked.entry;
      if (progress) progress(offset, limit_);
      if (entry.first < next || entry.first + entry.count < entry.first) {
        lose({offset, "CHNK", number, {}, entry.first, 0, "its records are those of another"});
        continue;
      }
      if (entry.first > next) lose_range(next, entry.first, offset);
      next = entry.first + entry.count;
      if (!walked.readable) {
        lose({offset, "CHNK", number++, {}, entry.first, entry.count, "its frame cannot be read"});
        continue;
      }
      const std::vector<Fault> faults = reader.read(entry, number++);
      report_.faults.insert(report_.faults.end(), faults.begin(), faults.end());
      if (!faults.empty()) {
        lose(faults.front());
        continue;
      }
      if (pass && *pass != entry.pass) appender_->commit({});
      pass = entry.pass;
      appender_->add_chunk(entry.count, reader.columns());
      ++report_.chunks_saved;
    }
    const std::uint64_t total = walk_.commits.empty() ? 0 : walk_.commits.back().commit.records;
    if (total > next) lose_range(next, total, walk_.end);
  }

  void lose_range(std::uint64_t first, std::uint64_t last, std::uint64_t before) {
    lose({before, "", {}, {}, first, last - first, "nothing of them can be found before here"});
  }

  void lose(Fault fault) {
    report_.records_lost += fault.records;
    report_.losses.push_back(std::move(fault));
  }

  // Between the last readable commit and a later one there may have been more than was found.
  void check_end() {
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
