// Saves the records of tables in a recovery: README.md, "Recovery".
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "formats/check/check.h"
#include "formats/check/column_reader.h"
#include "formats/check/table_passes.h"
#include "formats/check/walk.h"
#include "formats/write/appender.h"

namespace psf::formats {

class TableRecovery {
 public:
  // All must outlive it.
  TableRecovery(const Walk& walk, ColumnReader& reader, Appender& appender)
      : walk_(walk), reader_(reader), appender_(appender), tables_(table_passes(walk)) {}

  // Saves what the tables have of a pass whose paths were all saved, each table's records as a
  // whole or not at all. Adds what is wrong with them to `faults`; returns the number of chunks.
  std::uint64_t save(std::uint32_t pass, std::vector<Fault>& faults);

  // What was not saved. `broken`: passes of which paths are lost. `uncommitted`: passes that no
  // commit counts were asked for, and are no loss.
  [[nodiscard]] std::vector<Fault> losses(const std::set<std::uint32_t>& broken,
                                          bool uncommitted) const;

 private:
  [[nodiscard]] bool is_whole(const TablePass& pass, std::vector<Fault>& faults);

  const Walk& walk_;
  ColumnReader& reader_;
  Appender& appender_;
  std::vector<TablePasses> tables_;
};

}  // namespace psf::formats
