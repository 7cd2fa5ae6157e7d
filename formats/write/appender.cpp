#include "formats/write/appender.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <climits>
#include <limits>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "formats/layout/file.h"
#include "formats/layout/head_frame.h"
#include "formats/layout/layout.h"
#include "formats/layout/metadata.h"
#include "formats/read/open.h"

namespace psf::formats {
namespace {

constexpr const char* kPartial = ".partial";

[[noreturn]] void refuse_appending(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::bad_input, fmt::format("{}: {}", path, why));
}

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
    static_cast<void>(parse_metadata(head.metadata));
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("{}: {}", path, error.what()));
  }
}

std::string scene_hash_of(const std::string& path, const Head& head) {
  try {
    return parse_metadata(head.metadata).scene_hash;
  } catch (const Error& error) {
    refuse_appending(path, error.what());
  }
}

void check_same(const std::string& path, const Head& own, const Head& wanted) {
  constexpr const char* kRemedy = "it is unchanged; give another name to write a new file";
  if (own.minor > kMinor || own.optional_features != 0) {
    refuse_appending(
        path, fmt::format("written by version {}.{} of the format, which this program reads but "
                          "cannot continue; {}",
                          own.major, own.minor, kRemedy));
  }
  for (std::size_t k = 0; k < std::max(own.channels.size(), wanted.channels.size()); ++k) {
    const auto name = [k](const Head& head) {
      return k < head.channels.size() ? to_text(head.channels[k]) : "nothing";
    };
    if (name(own) == name(wanted)) continue;
    refuse_appending(path, fmt::format("has other channels: as number {} {}, not {}; {}", k,
                                       name(own), name(wanted), kRemedy));
  }
  for (std::size_t k = 0; k < std::max(own.tables.size(), wanted.tables.size()); ++k) {
    const auto described = [k](const Head& head) {
      return k < head.tables.size() ? to_text(head.tables[k]) : "none";
    };
    if (described(own) == described(wanted)) continue;
    refuse_appending(path, fmt::format("has other tables: as number {} {}, not {}; {}", k + 1,
                                       described(own), described(wanted), kRemedy));
  }
  const std::string before = scene_hash_of(path, own), now = scene_hash_of(path, wanted);
  if (before != now) {
    refuse_appending(path, fmt::format("is of another scene: its scene_hash is '{}', not '{}'; {}",
                                       before, now, kRemedy));
  }
}

}  // namespace

std::unique_ptr<Appender> Appender::create(const std::string& path, const Head& head,
                                           const WriterOptions& options, Appear appear) {
  check_target(path);
  check_head(path, head);
  FrameWriter frames(File::create(partial_path(path)), options.uuid ? *options.uuid : make_uuid());
  std::unique_ptr<Appender> made(new Appender(path, head, options.sync, std::move(frames)));
  made->appear_ = appear;
  made->unfinished_.emplace(partial_path(path));
  // A file that grows under this name would be lost when ours gets it.
  if (File::is_being_written(path)) {
    throw Error(ErrorCode::io,
                path + ": another process is writing it; wait for it or choose another name");
  }
  made->frames_->write_start(head);
  return made;
}

std::unique_ptr<Appender> Appender::resume(const std::string& path, const Head& head,
                                           const WriterOptions& options) {
  File file = File::update(path);
  const Opened opened = open_buffer(file);
  check_same(path, opened.head, head);
  std::vector<std::byte> state;
  try {
    state = read_section(file, opened.last, opened.commit.resume);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::io) throw;
    refuse_appending(
        path, fmt::format("resume state of the commit at byte {}: {}; it cannot be continued",
                          opened.last.prefix.offset, error.what()));
  }

  FrameWriter frames(std::move(file), opened.head_frame, opened.last.prefix);
  std::unique_ptr<Appender> made(new Appender(path, opened.head, options.sync, std::move(frames)));
  made->appeared_ = true;
  made->untouched_ = true;
  const Prefix& last = opened.last.prefix;
  made->last_record_ = {last.offset, last.length, last.sequence};
  made->resume_ = std::move(state);
  for (std::size_t k = 0; k < made->tables_.size(); ++k) {
    const std::uint64_t records = opened.commit.records_of(k);
    made->tables_[k] = {opened.chunks[k], records, records};
  }
  made->previous_ = made->anchor(opened.last.prefix.offset);
  if (opened.commit.number >= kIndexLeap && opened.root > 0) {
    made->leap_ = {opened.root, opened.root_chunks};
  }
  made->committed_end_ = opened.last.end();
  made->commits_ = opened.commit.number;
  made->last_flags_ = opened.commit.flags;
  made->passes_ = opened.commit.passes;
  return made;
}

Appender::Appender(const std::string& path, const Head& head, bool sync, FrameWriter frames)
    : path_(path),
      head_(head),
      sync_(sync),
      frames_(std::move(frames)),
      tables_(head.table_count()),
      start_(anchor(0)),
      previous_(start_),
      leap_(start_) {}

Appender::~Appender() {
  if (!frames_) return;
  try {
    if (appeared_ && !untouched_) {
      frames_->file().truncate(committed_end_);  // what is not committed is of no use to anyone
    }
  } catch (const Error&) {
    // An uncommitted tail is normal, and readers know it.
  }
}

// Before the first write to a resumed file: cuts off what is not committed, and writes the last
// commit to both slot records, since an old record may name a commit that is cut off.
void Appender::begin_writing() {
  if (!untouched_) return;
  untouched_ = false;
  frames_->file().truncate(committed_end_);
  frames_->write_slot(commits_, last_record_);
  frames_->write_slot(commits_ + 1, last_record_);
}

void Appender::add_chunk(std::size_t table, std::uint32_t count,
                         std::span<const EncodedColumn> columns) {
  begin_writing();
  if (passes_ >= std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorCode::limit, path_ + ": more than 2^32 - 1 passes");
  }
  TableState& to = tables_[table];
  to.index.push_back(frames_->write_chunk(
      {table, to.appended, count, static_cast<std::uint32_t>(passes_), {}}, columns));
  to.appended += count;
}

bool Appender::has_uncommitted() const {
  return std::any_of(tables_.begin(), tables_.end(),
                     [](const TableState& table) { return table.appended != table.committed; });
}

void Appender::commit(std::span<const std::byte> resume_state) {
  if (resume_state.size() > kMaxResumeState) {
    throw Error(ErrorCode::limit, fmt::format("{}: {} bytes of resume state; at most {} fit", path_,
                                              resume_state.size(), kMaxResumeState));
  }
  if (appended() == records()) {
    throw Error(ErrorCode::usage, path_ + ": a pass without records cannot be committed");
  }
  ++passes_;
  resume_.assign(resume_state.begin(), resume_state.end());
  write_commit(0);
}

void Appender::close() {
  if (has_uncommitted()) {
    throw Error(ErrorCode::usage, path_ + ": records were appended but not committed");
  }
  if (commits_ == 0) throw Error(ErrorCode::usage, path_ + ": closed without a pass");
  if ((last_flags_ & kClosed) == 0) write_commit(kClosed);
  closed_ = true;
  if (appear_ == Appear::first_commit) finish();
}

void Appender::publish() {
  // Before it has the name, which is then that of a whole file or none; after, nothing may fail.
  frames_->file().flush();
  appear();
  bytes_ = frames_->end();
  frames_.reset();
}

Appender::Anchor Appender::anchor(std::uint64_t offset) const {
  Anchor here{offset, {}};
  for (const TableState& table : tables_) here.chunks.push_back(table.index.size());
  return here;
}

Commit Appender::commit_on(const Anchor& base, std::uint32_t flags) const {
  Commit commit;
  commit.flags = flags;
  commit.number = commits_ + 1;
  commit.records = appended();
  commit.chunks = tables_[0].index.size();
  commit.passes = passes_;
  commit.previous = previous_.offset;
  commit.base = base.offset;
  commit.first_chunk = base.chunks[0];
  for (std::size_t k = 1; k < tables_.size(); ++k) {
    const std::vector<ChunkEntry>& index = tables_[k].index;
    commit.tables.push_back(
        {tables_[k].appended,
         index.size(),
         base.chunks[k],
         {index.begin() + static_cast<std::ptrdiff_t>(base.chunks[k]), index.end()}});
  }
  return commit;
}

// The one of the rule, README.md, "The index"; a later base where the tables' indices do not fit
// into a directory.
Commit Appender::next_commit(std::uint32_t flags) const {
  const std::uint64_t number = commits_ + 1;
  const std::array<const Anchor*, 3> bases = {&start_, &leap_, &previous_};
  for (std::size_t k = flags == kClosed || number % kIndexLeap == 0 ? 0
                       : number % kIndexStep == 0                   ? 1
                                                                    : 2;
       k < bases.size(); ++k) {
    Commit commit = commit_on(*bases[k], flags);
    if (commit_directory(commit) <= kMaxDirectory) return commit;
  }
  throw Error(ErrorCode::limit,
              fmt::format("{}: too many chunks of tables in one pass; use larger chunks", path_));
}

void Appender::write_commit(std::uint32_t flags) {
  begin_writing();
  const Commit commit = next_commit(flags);
  if (sync_) frames_->file().sync();
  const SlotRecord record = frames_->write_commit(
      commit, std::span(tables_[0].index).subspan(static_cast<std::size_t>(commit.first_chunk)),
      resume_);
  if (sync_) frames_->file().sync();
  frames_->write_slot(commit.number, record);
  if (!appeared_ && appear_ == Appear::first_commit) appear();
  commits_ = commit.number;
  last_flags_ = flags;
  for (TableState& table : tables_) table.committed = table.appended;
  committed_end_ = frames_->end();
  previous_ = anchor(record.offset);
  if (commits_ % kIndexLeap == 0) leap_ = previous_;
}

void Appender::appear() {
  rename_file(current_path(), path_, sync_);
  unfinished_->keep();
  frames_->file().set_path(path_);
  appeared_ = true;
}

void Appender::finish() {
  bytes_ = frames_->end();
  frames_->file().close();
  frames_.reset();
}

std::string Appender::current_path() const {
  return appeared_ ? path_ : partial_path(path_);
}

std::string Appender::partial_path(const std::string& path) {
  const std::size_t name = path.rfind('/') + 1;  // 0 where there is none
  const std::size_t most = NAME_MAX - std::string_view(kPartial).size();
  return path.substr(0, name) + path.substr(name, most) + kPartial;
}

}  // namespace psf::formats
