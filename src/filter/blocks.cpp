#include "filter/blocks.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "core/error.h"

namespace psf::filter {
namespace {

// b^m, stopping above `enough`.
std::uint64_t power_up_to(std::uint64_t base, std::uint32_t exponent, std::uint64_t enough) {
  std::uint64_t value = 1;
  for (std::uint32_t k = 0; k < exponent && value <= enough; ++k) {
    if (value > std::numeric_limits<std::uint64_t>::max() / base) {
      return std::numeric_limits<std::uint64_t>::max();
    }
    value *= base;
  }
  return value;
}

}  // namespace

Blocks::Blocks(const BlockSize& size, std::vector<std::uint64_t> pass_bounds,
               std::size_t first_pass, std::size_t last_pass)
    : size_(size), bounds_(std::move(pass_bounds)), first_pass_(first_pass), last_pass_(last_pass) {
  assert(first_pass <= last_pass && last_pass < bounds_.size());
  all_ = {bounds_[first_pass], bounds_[last_pass]};
  if (all_.size() == 0) return;
  switch (size_.kind) {
    case BlockSize::Kind::power:
      length_ = power_up_to(size_.base, size_.exponent, all_.last);
      count_ = (all_.last - 1) / length_ - all_.first / length_ + 1;
      break;
    case BlockSize::Kind::passes: {
      const std::uint64_t passes = last_pass - first_pass;
      count_ = passes / size_.passes + (passes % size_.passes != 0 ? 1 : 0);
      break;
    }
    case BlockSize::Kind::all:
      count_ = 1;
      break;
  }
  std::uint64_t longest = 0;
  if (size_.kind == BlockSize::Kind::power) {
    longest = std::min(length_, all_.size());
  } else {
    for (std::uint64_t k = 0; k < count_; ++k) longest = std::max(longest, (*this)[k].size());
  }
  if (longest > kMostPaths) {
    throw Error(ErrorCode::limit, "`block`: a block has " + std::to_string(longest) + " paths, " +
                                      std::to_string(kMostPaths) +
                                      " are the most; choose a smaller block or fewer passes");
  }
}

bool Blocks::is_whole(std::uint64_t k) const {
  if (k + 1 < count_) return true;
  switch (size_.kind) {
    case BlockSize::Kind::power:
      return all_.last % length_ == 0;
    case BlockSize::Kind::passes:
      return (last_pass_ - first_pass_) % size_.passes == 0;
    case BlockSize::Kind::all:
      break;
  }
  return false;
}

PathRange Blocks::operator[](std::uint64_t k) const {
  assert(k < count_);
  if (size_.kind == BlockSize::Kind::all) return all_;
  if (size_.kind == BlockSize::Kind::power) {
    const std::uint64_t first = (all_.first / length_ + k) * length_;
    const std::uint64_t rest = all_.last - std::min(first, all_.last);
    return {std::max(first, all_.first), rest > length_ ? first + length_ : all_.last};
  }
  const std::uint64_t passes = last_pass_ - first_pass_;
  const std::uint64_t from = k * size_.passes;
  const std::uint64_t to = passes - from > size_.passes ? from + size_.passes : passes;
  return {bounds_[first_pass_ + from], bounds_[first_pass_ + to]};
}

}  // namespace psf::filter
