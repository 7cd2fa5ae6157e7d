#include "run/block_reader.h"

#include <chrono>
#include <utility>

#include "core/interrupt.h"

namespace psf::run {

const BlockRecords& BlockReader::read(const filter::PathRange& range,
                                      const std::optional<filter::PathRange>& next) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  core::throw_if_interrupted("no picture was written");
  const bool is_ahead = ahead_ == range;
  if (ahead_) {
    ahead_.reset();
    aside_.wait();
  }
  if (is_ahead) {
    std::swap(current_, next_);
  } else {
    dump_.read(range, channels_, current_);
  }
  if (next) {
    ahead_ = next;
    aside_.start([this, block = *next] { dump_.read(block, channels_, next_); });
  } else {
    next_ = {};
  }
  seconds_ += std::chrono::duration<double>(Clock::now() - start).count();
  return current_;
}

}  // namespace psf::run
