#include "formats/writer.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "formats/codec.h"
#include "formats/error.h"
#include "formats/file.h"
#include "formats/frame_writer.h"
#include "formats/head_frame.h"
#include "formats/layout.h"

namespace psf::formats {
namespace {

// Records encoded at a time, all channels: bounds the memory, and enough for all threads.
constexpr std::size_t kBatchBytes = std::size_t{64} << 20;

void check_target(const std::string& path) {
  struct stat status {};
  if (path.empty() || (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode))) {
    throw Error(
        ErrorCode::io,
        fmt::format("'{}': cannot create: not the name of a regular file; choose another", path));
  }
}

void check_head(const std::string& path, const Head& head) {
  try {
    validate(head);
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("{}: {}", path, error.what()));
  }
  if (!nlohmann::json::parse(head.metadata, nullptr, false).is_object()) {
    throw Error(ErrorCode::bad_input, path + ": the metadata is no JSON object in UTF-8");
  }
}

}  // namespace

struct Writer::State {
  // A commit that a later one may build its index on: see README.md, "CMIT".
  struct Anchor {
    std::uint64_t offset = 0, chunks = 0;
  };

  State(const std::string& path, const Head& head, const WriterOptions& options)
      : path_(path), head_(head), options_(options) {
    check_target(path);
    check_head(path, head);
    frames_.emplace(File::create(path + ".partial"), options.uuid ? *options.uuid : make_uuid());
    pending_.resize(head_.channels.size());
  }

  ~State() {
    if (!frames_) return;
    try {
      if (commits_ == 0) {
        std::remove(frames_->file().path().c_str());
      } else {
        frames_->file().truncate(committed_end_);  // what is not committed is of no use to anyone
      }
    } catch (const Error&) {
      // An uncommitted tail is normal, and readers know it.
    }
  }

  // The first error of any call sticks.
  template <class Call>
  void guard(const Call& call) {
    if (error_) throw *error_;
    if (!frames_) throw Error(ErrorCode::usage, path_ + ": is closed already");
    try {
      call();
    } catch (const Error& error) {
      error_ = error;
      throw;
    } catch (const std::bad_alloc&) {
      error_ = Error(ErrorCode::limit, path_ + ": out of memory; use smaller chunks");
      throw *error_;
    }
  }

  void append(std::size_t count, std::span<const void* const> columns) {
    if (columns.size() != head_.channels.size()) {
      throw Error(ErrorCode::usage, fmt::format("{}: {} columns given for {} channels", path_,
                                                columns.size(), head_.channels.size()));
    }
    std::size_t done = 0;
    while (done < count) {
      const std::size_t capacity = head_.chunk_capacity;
      if (pending_count_ == 0 && count - done >= capacity) {
        const std::size_t most =
            std::max<std::size_t>(1, kBatchBytes / (capacity * head_.stride()));
        const std::size_t chunks = std::min(most, (count - done) / capacity);
        write_chunks(chunks, capacity, [&](std::size_t channel) {
          return static_cast<const std::byte*>(columns[channel]) +
                 done * head_.channels[channel].stride();
        });
        done += chunks * capacity;
        continue;
      }
      const std::size_t taken = std::min(count - done, capacity - pending_count_);
      for (std::size_t k = 0; k < columns.size(); ++k) {
        const std::size_t stride = head_.channels[k].stride();
        const auto* from = static_cast<const std::byte*>(columns[k]) + done * stride;
        pending_[k].insert(pending_[k].end(), from, from + taken * stride);
      }
      pending_count_ += taken;
      done += taken;
      if (pending_count_ == capacity) flush();
    }
  }

  void flush() {
    if (pending_count_ == 0) return;
    write_chunks(1, pending_count_, [&](std::size_t channel) { return pending_[channel].data(); });
    for (auto& column : pending_) column.clear();
    pending_count_ = 0;
  }

  // Encodes columns of chunks of `count` records each in parallel and writes the chunks in order.
  template <class Data>
  void write_chunks(std::size_t chunks, std::size_t count, const Data& data) {
    if (passes_ >= std::numeric_limits<std::uint32_t>::max()) {
      throw Error(ErrorCode::limit, path_ + ": more than 2^32 - 1 passes");
    }
    const std::size_t channels = head_.channels.size();
    const std::size_t jobs = chunks * channels;
    if (encoded_.size() < jobs) encoded_.resize(jobs);
    if (storage_.size() < jobs) storage_.resize(jobs);
    tbb::parallel_for(std::size_t{0}, jobs, [&](std::size_t job) {
      const std::size_t channel = job % channels;
      const std::size_t bytes = count * head_.channels[channel].stride();
      const std::byte* from = data(channel) + job / channels * bytes;
      encoded_[job] = encode_column(options_.codec, {from, bytes}, storage_[job]);
    });
    for (std::size_t k = 0; k < chunks; ++k) {
      index_.push_back(frames_->write_chunk(appended_, static_cast<std::uint32_t>(count),
                                            static_cast<std::uint32_t>(passes_),
                                            std::span(encoded_).subspan(k * channels, channels)));
      appended_ += count;
    }
  }

  void commit(std::span<const std::byte> resume_state) {
    if (resume_state.size() > kMaxResumeState) {
      throw Error(ErrorCode::limit, fmt::format("{}: {} bytes of resume state; at most {} fit",
                                                path_, resume_state.size(), kMaxResumeState));
    }
    flush();
    if (appended_ == committed_) {
      throw Error(ErrorCode::usage, path_ + ": a pass without records cannot be committed");
    }
    ++passes_;
    resume_.assign(resume_state.begin(), resume_state.end());
    write_commit(0);
  }

  void close() {
    if (pending_count_ > 0 || appended_ != committed_) {
      throw Error(ErrorCode::usage, path_ + ": records were appended but not committed");
    }
    if (commits_ == 0) throw Error(ErrorCode::usage, path_ + ": closed without a pass");
    write_commit(kClosed);
    bytes_ = frames_->end();
    frames_->file().close();
    frames_.reset();
  }

  void write_commit(std::uint32_t flags) {
    const std::uint64_t number = commits_ + 1;
    const Anchor base = flags == kClosed || number % kIndexLeap == 0 ? Anchor{}
                        : number % kIndexStep == 0                   ? leap_
                                                                     : previous_;
    Commit commit;
    commit.flags = flags;
    commit.number = number;
    commit.records = appended_;
    commit.chunks = index_.size();
    commit.passes = passes_;
    commit.previous = previous_.offset;
    commit.base = base.offset;
    commit.first_chunk = base.chunks;
    File& file = frames_->file();
    if (options_.sync) file.sync();
    const SlotRecord record = frames_->write_commit(
        commit, std::span(index_).subspan(static_cast<std::size_t>(base.chunks)), resume_);
    if (options_.sync) file.sync();
    frames_->write_slot(number, record);
    if (commits_ == 0) {
      rename_file(file.path(), path_, options_.sync);
      file.set_path(path_);
    }
    commits_ = number;
    committed_ = appended_;
    committed_end_ = frames_->end();
    previous_ = {record.offset, index_.size()};
    if (number % kIndexLeap == 0) leap_ = previous_;
  }

  [[nodiscard]] std::uint64_t bytes() const { return frames_ ? frames_->end() : bytes_; }

  std::string path_;
  Head head_;
  WriterOptions options_;
  std::optional<FrameWriter> frames_;  // until closed
  std::optional<Error> error_;

  std::vector<std::byte> resume_;
  std::vector<ChunkEntry> index_;  // of all chunks
  Anchor previous_, leap_;

  std::uint64_t committed_end_ = 0, bytes_ = 0;
  std::uint64_t commits_ = 0, passes_ = 0;
  std::uint64_t appended_ = 0, committed_ = 0;  // records; appended: in chunks

  std::vector<std::vector<std::byte>> pending_;  // a column each, of the chunk being filled
  std::size_t pending_count_ = 0;
  std::vector<EncodedColumn> encoded_;
  std::vector<Buffer> storage_;
};

Writer::Writer(const std::string& path, const Head& head, const WriterOptions& options)
    : state_(std::make_unique<State>(path, head, options)) {
  state_->frames_->write_start(head);
}

Writer::~Writer() = default;

void Writer::append(std::size_t count, std::span<const void* const> columns) {
  state_->guard([&] { state_->append(count, columns); });
}

void Writer::commit(std::span<const std::byte> resume_state) {
  state_->guard([&] { state_->commit(resume_state); });
}

void Writer::close() {
  state_->guard([&] { state_->close(); });
}

std::uint64_t Writer::records() const {
  return state_->committed_;
}
std::uint64_t Writer::bytes_written() const {
  return state_->bytes();
}

}  // namespace psf::formats
