// The blocks of a dump, one after the other: the loop of everything that filters whole dumps.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "filter/blocks.h"
#include "filter/records.h"
#include "run/block_reader.h"
#include "run/dump.h"

namespace psf::run {

class BlockLoop {
 public:
  // A block, valid until the next one.
  struct Visit {
    std::uint64_t number;  // from 0
    filter::PathRange paths;
    const filter::Records& records;
    const filter::Block& block;
    std::uint64_t not_finite_in_layers;  // values of layers of the light that were made 0
    std::uint64_t not_finite_coverage;   // values of alpha that were made 1
  };
  using Visitor = std::function<void(const Visit&)>;

  // `dump` must outlive the loop. `first_pass`: where the selection begins.
  BlockLoop(const Dump& dump, const ChannelSet& channels, const filter::BlockSize& size,
            filter::RadiusCount count, std::size_t first_pass);

  // Sets the end of the selection, not included, which may only grow. `read_ahead`: reads a block
  // while the one before is visited, which takes the memory of a second block.
  void set_last(std::size_t last_pass, bool read_ahead);

  // Visits every block of the selection that was not visited yet, but for a last one that more
  // passes would change. Returns whether there is such a one: visit_rest() visits it, as often as
  // it is called. Throws Error{interrupted}, and what Dump::read() and the visitor throw.
  [[nodiscard]] bool visit_whole(const Visitor& visit);
  void visit_rest(const Visitor& visit);

  [[nodiscard]] std::uint64_t count() const { return blocks_->count(); }  // of the selection
  [[nodiscard]] filter::PathRange all() const { return blocks_->all(); }  // its paths
  [[nodiscard]] const ChannelSet& channels() const { return channels_; }
  // The seconds that visitors waited for the reader, which works beside them.
  [[nodiscard]] double seconds_read() const { return reader_.seconds(); }

 private:
  void visit(std::uint64_t k, const Visitor& visit);

  const Dump& dump_;
  ChannelSet channels_;
  filter::BlockSize size_;
  filter::RadiusCount count_;
  std::size_t first_;  // pass
  bool read_ahead_ = false;
  std::optional<filter::Blocks> blocks_;
  std::uint64_t next_ = 0;
  BlockReader reader_;
};

}  // namespace psf::run
