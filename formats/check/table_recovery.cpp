#include "formats/check/table_recovery.h"

#include <fmt/format.h>

#include "formats/layout/layout.h"

namespace psf::formats {

std::uint64_t TableRecovery::save(std::uint32_t pass, std::vector<Fault>& faults) {
  std::uint64_t chunks = 0;
  for (std::size_t k = 0; k < tables_.size(); ++k) {
    const auto found = tables_[k].passes.find(pass);
    if (found == tables_[k].passes.end() || !is_whole(found->second, faults)) continue;
    for (const TablePass::Numbered& of : found->second.chunks) {
      static_cast<void>(reader_.read(of.chunk, of.number));
      appender_.add_chunk(k + 1, of.chunk.entry.count, reader_.columns());
      ++chunks;
    }
    found->second.taken = true;
  }
  return chunks;
}

// Whether all columns of a pass are whole, too.
bool TableRecovery::is_whole(const TablePass& pass, std::vector<Fault>& faults) {
  bool whole = pass.whole;
  for (const TablePass::Numbered& of : pass.chunks) {
    if (!of.chunk.readable) continue;
    const std::vector<Fault> found = reader_.read(of.chunk, of.number);
    faults.insert(faults.end(), found.begin(), found.end());
    whole = whole && found.empty();
  }
  return whole;
}

std::vector<Fault> TableRecovery::losses(const std::set<std::uint32_t>& broken,
                                         bool uncommitted) const {
  const std::uint64_t committed = walk_.commits.empty() ? 0 : walk_.commits.back().commit.passes;
  std::vector<Fault> lost;
  for (std::size_t k = 0; k < tables_.size(); ++k) {
    lost.insert(lost.end(), tables_[k].gaps.begin(), tables_[k].gaps.end());
    for (const auto& [number, pass] : tables_[k].passes) {
      if (pass.taken || (uncommitted && number >= committed)) continue;
      const ChunkEntry& first = pass.chunks.front().chunk.entry;
      const ChunkEntry& last = pass.chunks.back().chunk.entry;
      lost.push_back({first.offset,
                      type_name(kTableChunkType),
                      pass.chunks.front().number,
                      {},
                      first.first,
                      last.first + last.count - first.first,
                      fmt::format("pass {} of it is left out: {}", number,
                                  broken.contains(number) ? "paths of this pass are lost"
                                                          : "a part of it is lost"),
                      walk_.head.head.tables[k].name});
    }
  }
  return lost;
}

}  // namespace psf::formats
