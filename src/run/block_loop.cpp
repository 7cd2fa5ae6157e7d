#include "run/block_loop.h"

#include "run/passes.h"

namespace psf::run {

BlockLoop::BlockLoop(const Dump& dump, const ChannelSet& channels, const filter::BlockSize& size,
                     filter::RadiusCount count, std::size_t first_pass)
    : dump_(dump),
      channels_(channels),
      size_(size),
      count_(count),
      first_(first_pass),
      reader_(dump, channels_) {}

void BlockLoop::set_last(std::size_t last_pass, bool read_ahead) {
  blocks_.emplace(size_, dump_.pass_bounds(), first_, last_pass);
  read_ahead_ = read_ahead;
}

bool BlockLoop::visit_whole(const Visitor& visit) {
  while (next_ < blocks_->count() && blocks_->is_whole(next_)) this->visit(next_++, visit);
  return next_ < blocks_->count();
}

void BlockLoop::visit_rest(const Visitor& visit) {
  this->visit(next_, visit);
}

void BlockLoop::visit(std::uint64_t k, const Visitor& visit) {
  const bool ahead = read_ahead_ && k + 1 < blocks_->count();
  const BlockRecords& read =
      reader_.read((*blocks_)[k], ahead ? std::optional((*blocks_)[k + 1]) : std::nullopt);
  const filter::Records records = read.view();
  std::uint64_t not_finite = 0;
  for (const BlockRecords::LayerColumns& layer : read.layers) {
    not_finite += layer.contribution.not_finite + layer.unfiltered.not_finite;
  }
  const filter::Block block = describe_block(dump_, *blocks_, k, count_);
  visit({k, (*blocks_)[k], records, block, not_finite, read.not_finite_coverage});
}

}  // namespace psf::run
