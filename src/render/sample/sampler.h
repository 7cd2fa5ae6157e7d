// The random numbers of paths: sequences of points in [0, 1)^s, and the assignment of paths to
// points.
#pragma once

#include <cstdint>
#include <string>

#include "core/vec.h"

namespace psf::render {

enum class SamplerKind : std::uint8_t { sobol, halton, independent };
enum class Enumeration : std::uint8_t {
  pixel,  // each pixel has its own randomised sequence; each pass takes its next point
  global  // one sequence over the image plane: b^m contiguous paths are a (t, m, s)-net
};

struct SamplerSettings {
  SamplerKind kind = SamplerKind::sobol;
  Enumeration enumeration = Enumeration::pixel;
  std::uint64_t seed = 0;
};

// The sample point of one path, read dimension by dimension. Samplers are cheap to make and share
// nothing, so paths can be traced in any order by any number of threads. Each number is a pure
// function of settings, sequence, index and dimension.
//
//   sobol        Owen-scrambled. With the global enumeration, the first 128 dimensions are one
//                Sobol' sequence, whose first two dimensions are a (0, 2)-sequence. Per pixel, and
//                beyond 128 dimensions, each next_1d() or next_2d() draws from a (0, 2)-sequence of
//                its own, in shuffled order.
//   halton       Owen-scrambled; the base of dimension d is the d-th prime. Beyond 128 dimensions
//                as sobol.
//   independent  A hash.
class Sampler {
 public:
  // `sequence`: number of the sequence (the pixel, or 0 for the global sequence). `index`: number
  // of the point in it, below 2^40.
  Sampler(const SamplerSettings& settings, std::uint32_t sequence, std::uint64_t index);

  [[nodiscard]] float next_1d();  // [0, 1), the next dimension
  [[nodiscard]] Vec2 next_2d();   // the next two dimensions, well distributed together
  // The sampler of the k-th of the `count` continuations that `--split` makes from x_i. The points
  // of all continuations together are well distributed too. index * count < 2^48.
  [[nodiscard]] Sampler split(std::uint32_t k, std::uint32_t count) const;

 private:
  [[nodiscard]] std::uint64_t
  take_key();  // returns the scrambling key of the next dimension, and goes on to the one after it
  [[nodiscard]] bool from_sequence(std::uint32_t count) const;  // for the next `count` dimensions

  SamplerKind kind_;
  bool global_;
  std::uint32_t dimension_ = 0;
  std::uint64_t seed_;  // hash of seed and sequence
  std::uint64_t index_;
};

// The base b of the (t, m, s)-nets, for Metadata::block_base.
[[nodiscard]] std::uint32_t block_base(SamplerKind kind);

}  // namespace psf::render
