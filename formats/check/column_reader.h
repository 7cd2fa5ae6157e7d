// Reads the columns of chunks as they are stored, and finds out which are whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/check/check.h"
#include "formats/check/walk.h"
#include "formats/layout/codec.h"
#include "formats/layout/file.h"

namespace psf::formats {

class ColumnReader {
 public:
  ColumnReader(const File& file, const Walk& walk) : file_(file), walk_(walk) {}

  // What is wrong with the columns of a chunk, which is number `number` of its table; nothing where
  // columns() has them all.
  [[nodiscard]] std::vector<Fault> read(const WalkedChunk& walked, std::uint64_t number);

  // Those of the last chunk that was read.
  [[nodiscard]] std::span<const EncodedColumn> columns() const { return columns_; }

 private:
  const File& file_;
  const Walk& walk_;
  std::vector<EncodedColumn> columns_;
  std::vector<Buffer> stored_, decoded_;
};

}  // namespace psf::formats
