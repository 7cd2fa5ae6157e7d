// Appends chunks and commits to a path-vertex buffer, and keeps its index and its name. Writer,
// recover() and concatenate() write with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/unfinished.h"
#include "formats/layout/codec.h"
#include "formats/layout/head.h"
#include "formats/write/frame_writer.h"
#include "formats/write/writer_options.h"

namespace psf::formats {

class Appender {
 public:
  // The moment at which a new file gets its name: its first commit, or publish().
  enum class Appear { first_commit, published };

  // Starts a new file with HEAD and SLOT; it is called `path`.partial until it gets its name.
  // Throws Error{bad_input} for a head that breaks the rules, Error{io} where another process is
  // writing a file of this name.
  [[nodiscard]] static std::unique_ptr<Appender> create(const std::string& path, const Head& head,
                                                        const WriterOptions& options,
                                                        Appear appear);
  // Goes on behind the last commit of an existing file; what follows this commit is cut off before
  // the first write. Throws Error{bad_input} where the file is no path-vertex buffer, has other
  // channels or another scene hash than `head`, or was written by a later version.
  [[nodiscard]] static std::unique_ptr<Appender> resume(const std::string& path, const Head& head,
                                                        const WriterOptions& options);

  Appender(const Appender&) = delete;
  Appender& operator=(const Appender&) = delete;
  // Cuts off what is not committed; removes a file that did not appear.
  ~Appender();

  // Appends a chunk of `count` records of a table (0: the paths) to the current pass, which began
  // with the last commit.
  void add_chunk(std::size_t table, std::uint32_t count, std::span<const EncodedColumn> columns);
  // Ends the current pass.
  void commit(std::span<const std::byte> resume_state);
  // Commits once more, with the flag "closed". With Appear::published the file stays locked until
  // publish(), which gives it its name.
  void close();
  void publish();

  // The name of a new file until it appears: `path`.partial, where a long name is cut. No input of
  // the program that writes it may have this name.
  [[nodiscard]] static std::string partial_path(const std::string& path);

  [[nodiscard]] const std::string& path() const { return path_; }  // the final one
  [[nodiscard]] std::string current_path() const;                  // `path`.partial before that
  [[nodiscard]] const Head& head() const { return head_; }         // the file's own
  [[nodiscard]] bool is_open() const { return frames_ && !closed_; }
  // Numbers of records of a table.
  [[nodiscard]] std::uint64_t records(std::size_t table = 0) const {
    return tables_[table].committed;
  }
  [[nodiscard]] std::uint64_t appended(std::size_t table = 0) const {
    return tables_[table].appended;
  }
  [[nodiscard]] std::uint64_t passes() const { return passes_; }
  [[nodiscard]] std::uint64_t bytes() const { return frames_ ? frames_->end() : bytes_; }
  [[nodiscard]] std::span<const std::byte> resume_state() const { return resume_; }

 private:
  // A commit on whose index that of a later one may build: see README.md, "CMIT".
  struct Anchor {
    std::uint64_t offset = 0;
    std::vector<std::uint64_t> chunks;  // a number a table
  };
  // What the file has of the paths, or of a table.
  struct TableState {
    std::vector<ChunkEntry> index;              // entries of all chunks
    std::uint64_t appended = 0, committed = 0;  // numbers of records
  };

  Appender(const std::string& path, const Head& head, bool sync, FrameWriter frames);
  void begin_writing();
  [[nodiscard]] bool has_uncommitted() const;
  [[nodiscard]] Anchor anchor(std::uint64_t offset) const;
  [[nodiscard]] Commit commit_on(const Anchor& base, std::uint32_t flags) const;
  [[nodiscard]] Commit next_commit(std::uint32_t flags) const;
  void write_commit(std::uint32_t flags);
  void appear();
  void finish();

  std::string path_;
  Head head_;
  bool sync_ = true;
  Appear appear_ = Appear::first_commit;
  bool appeared_ = false, closed_ = false;
  bool untouched_ = false;             // resumed, and nothing written yet
  SlotRecord last_record_;             // slot record of the commit that was resumed from
  std::uint32_t last_flags_ = 0;       // flags of the last commit
  std::optional<FrameWriter> frames_;  // empty once the file is finished
  // Set for a new file until it appears. It removes the file before frames_ gives up the lock.
  std::optional<core::Unfinished> unfinished_;

  std::vector<std::byte> resume_;
  std::vector<TableState> tables_;  // the first is that of the paths
  Anchor start_, previous_, leap_;  // start_: the index begins with the first chunk
  std::uint64_t committed_end_ = 0, bytes_ = 0;
  std::uint64_t commits_ = 0, passes_ = 0;
};

}  // namespace psf::formats
