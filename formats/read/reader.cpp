#include "formats/read/reader.h"

#include <fmt/format.h>

#include <utility>

#include "core/error.h"
#include "formats/layout/commit.h"
#include "formats/layout/head_frame.h"
#include "formats/layout/layout.h"
#include "formats/read/open.h"

namespace psf::formats {

struct Reader::State {
  explicit State(const std::string& path) : file(File::open(path)), opened(open_buffer(file)) {
    for (std::size_t k = 0; k < opened.head.table_count(); ++k) {
      tables.push_back(std::make_unique<TableReader>(file, opened, k));
    }
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw Error(ErrorCode::bad_input, fmt::format("{}: {}", file.path(), why));
  }

  File file;
  Opened opened;
  std::vector<std::unique_ptr<TableReader>> tables;  // the first is that of the paths
};

Reader::Reader(const std::string& path) : state_(std::make_unique<State>(path)) {}
Reader::~Reader() = default;
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;

bool Reader::refresh() {
  State& state = *state_;
  if (!state.file.is_named()) state.fail("was replaced by another file while it was being read");
  if (state.file.size() <= state.opened.last.end()) return false;
  Opened now = open_buffer(state.file);
  const bool more = now.commit.number > state.opened.commit.number;
  state.opened = std::move(now);
  for (const auto& table : state.tables) table->refresh();
  return more;
}

bool Reader::is_being_written() const {
  return File::is_being_written(path());
}

const std::string& Reader::path() const {
  return state_->file.path();
}
const Head& Reader::head() const {
  return state_->opened.head;
}
const TableReader& Reader::table(std::size_t number) const {
  return *state_->tables.at(number);
}
const TableReader* Reader::find_table(std::string_view name) const {
  const auto found = head().find_table(name);
  return found ? &table(*found) : nullptr;
}
bool Reader::closed() const {
  return (state_->opened.commit.flags & kClosed) != 0;
}
std::uint64_t Reader::uncommitted_bytes() const {
  return state_->opened.file_size - state_->opened.last.end();
}
std::string Reader::uuid() const {
  return to_text(state_->opened.uuid);
}
std::uint64_t Reader::file_bytes() const {
  return state_->opened.file_size;
}

std::vector<std::byte> Reader::resume_state() const {
  try {
    return read_section(state_->file, state_->opened.last, state_->opened.commit.resume);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::io) throw;
    state_->fail(fmt::format("resume state of the commit at byte {}: {}",
                             state_->opened.last.prefix.offset, error.what()));
  }
}

}  // namespace psf::formats
