// As many random numbers as a loop of unknown length asks for, at the price of two of a path's.
#pragma once

#include "render/sample/sampler.h"
#include "render/sample/sampler_hash.h"

namespace psf::render {

// Numbers that follow from the two dimensions that it takes of the sampler, and from nothing else. So
// whatever a path draws behind the loop has the same dimensions as on every other path.
class Stream {
 public:
  explicit Stream(Sampler& sampler) {
    const Vec2 u = sampler.next_2d();
    const auto bits = [](float x) { return static_cast<std::uint64_t>(x * 0x1p24f); };
    state_ = mix((bits(u.x) << 24 | bits(u.y)) + kGolden);
  }
  [[nodiscard]] float next() {  // [0, 1)
    state_ += kGolden;
    return to_unit(high(mix(state_)));
  }

 private:
  std::uint64_t state_;
};

}  // namespace psf::render
