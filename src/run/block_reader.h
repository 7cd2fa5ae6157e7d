// Reads the blocks of a dump; the next block is read while the caller works on this one.
#pragma once

#include <optional>

#include "core/parallel.h"
#include "filter/blocks.h"
#include "run/block_records.h"
#include "run/dump.h"

namespace psf::run {

class BlockReader {
 public:
  // Dump and channels must outlive the reader. The dump must not be refreshed while a block is
  // being read ahead.
  BlockReader(const Dump& dump, const ChannelSet& channels) : dump_(dump), channels_(channels) {}

  // The records of the block `range`, valid until the next call. Where `next` is given, that block
  // is read beside the caller's work, which takes the memory of a second block. Throws
  // Error{interrupted} and what Dump::read() throws; errors of a block read ahead are thrown when
  // it is asked for.
  [[nodiscard]] const BlockRecords& read(const filter::PathRange& range,
                                         const std::optional<filter::PathRange>& next);
  // The seconds that the caller waited for read().
  [[nodiscard]] double seconds() const { return seconds_; }

 private:
  const Dump& dump_;
  const ChannelSet& channels_;
  BlockRecords current_, next_;
  std::optional<filter::PathRange> ahead_;  // what `next_` will hold
  double seconds_ = 0;
  core::Aside aside_;  // destroyed first: it writes to `next_`
};

}  // namespace psf::run
