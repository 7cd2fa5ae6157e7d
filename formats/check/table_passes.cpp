#include "formats/check/table_passes.h"

#include <string>
#include <utility>

namespace psf::formats {
namespace {

// Follows the chunks of one table through the file.
class Follower {
 public:
  explicit Follower(std::string name) : name_(std::move(name)) {}

  void add(const WalkedChunk& chunk) {
    const ChunkEntry& entry = chunk.entry;
    TablePass& pass = found_.passes[entry.pass];
    if (entry.first != next_) break_at(entry.first, entry.offset, &pass);
    if (!chunk.readable) pass.whole = false;
    pass.chunks.push_back({chunk, number_++});
    next_ = entry.first + entry.count;
    last_ = &pass;
  }

  // `total` records in `passes` passes were committed, the last of them before the byte `end`.
  TablePasses end(std::uint64_t total, std::uint64_t passes, std::uint64_t end) {
    if (total > next_) break_at(total, end, nullptr);
    for (auto& [number, pass] : found_.passes) pass.whole = pass.whole && number < passes;
    return std::move(found_);
  }

 private:
  // The records from the next on up to `until` are missing, or some come twice: they may be of the
  // pass before and of the one behind.
  void break_at(std::uint64_t until, std::uint64_t offset, TablePass* behind) {
    if (last_ != nullptr) last_->whole = false;
    if (behind != nullptr) behind->whole = false;
    if (until <= next_) return;
    found_.gaps.push_back({offset,
                           "",
                           {},
                           {},
                           next_,
                           until - next_,
                           "nothing of them can be found before here",
                           name_});
  }

  std::string name_;
  TablePasses found_;
  TablePass* last_ = nullptr;
  std::uint64_t next_ = 0, number_ = 0;  // record, chunk
};

}  // namespace

std::vector<TablePasses> table_passes(const Walk& walk) {
  std::vector<Follower> followers;
  for (const Table& table : walk.head.head.tables) followers.emplace_back(table.name);
  for (const auto& [offset, chunk] : walk.chunks) {
    if (chunk.table > 0) followers[chunk.table - 1].add(chunk);
  }
  std::vector<TablePasses> found;
  const Commit last = walk.commits.empty() ? Commit{} : walk.commits.back().commit;
  for (std::size_t k = 0; k < followers.size(); ++k) {
    const std::uint64_t total = last.tables.empty() ? 0 : last.tables[k].records;
    found.push_back(followers[k].end(total, last.passes, walk.end));
  }
  return found;
}

}  // namespace psf::formats
