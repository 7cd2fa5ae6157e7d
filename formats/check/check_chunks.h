// The part of a check that is about chunks: what indices and totals say of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/check/check.h"
#include "formats/check/walk.h"
#include "formats/layout/file.h"

namespace psf::formats {

class ChunkCheck {
 public:
  // All must outlive it; faults go to the report.
  ChunkCheck(const File& file, Walk& walk, CheckResult& report)
      : file_(file), walk_(walk), report_(report) {}

  // Adds to the walk what the index of a commit has of a table, as Head::schema() counts, and finds
  // what contradicts other indices and the chunks themselves.
  void merge_index(const WalkedCommit& walked, std::size_t table,
                   const std::vector<ChunkEntry>& entries);
  // Every record once, in order; totals of every commit. After all indices.
  void check();

 private:
  // What was found of a table up to a place in the file.
  struct Found {
    std::uint64_t records = 0, chunks = 0, passes = 0;
  };
  void check_totals(const WalkedCommit& walked, const std::vector<Found>& found);
  // `next`: the commit behind the chunk; null where there is none.
  void check_place(const WalkedChunk& chunk, const Found& before, const Commit* next);
  void add_unreadable(const WalkedChunk& chunk, const Found& before);
  void add_fault(std::size_t table, Fault fault);
  [[nodiscard]] std::string text_of(std::size_t table, const ChunkEntry& entry) const;

  const File& file_;
  Walk& walk_;
  CheckResult& report_;
};

}  // namespace psf::formats
