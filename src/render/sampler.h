// The numbers a path is made of: sequences of points in [0, 1)^s, and how paths are numbered by
// them.
#pragma once

#include <cstdint>
#include <string>

#include "core/vec.h"

namespace psf::render {

enum class SamplerKind : std::uint8_t { sobol, halton, independent };
enum class Enumeration : std::uint8_t {
  pixel,  // each pixel has its own randomised sequence, a pass is its next point
  global  // one sequence over the image plane: b^m contiguous paths are a (t, m, s)-net
};

struct SamplerSettings {
  SamplerKind kind = SamplerKind::sobol;
  Enumeration enumeration = Enumeration::pixel;
  std::uint64_t seed = 0;
};

// The sample point of one path, read dimension by dimension. A value: cheap to make, nothing
// shared, so paths can be traced in any order by any number of threads. Each number is a pure
// function of settings, sequence, index and dimension.
//
//   sobol        Owen-scrambled. Global: the first 128 dimensions are one Sobol' sequence, the
//   first
//                two a (0, 2)-sequence. Per pixel, and past them: each next_1d or next_2d draws
//                from a (0, 2)-sequence of its own, in shuffled order.
//   halton       Owen-scrambled, dimension d in base the d-th prime; as sobol past 128 dimensions.
//   independent  a hash.
class Sampler {
 public:
  // `sequence`: which randomisation (the pixel, or 0 for the global sequence); `index`: which point
  // of it, below 2^40.
  Sampler(const SamplerSettings& settings, std::uint32_t sequence, std::uint64_t index);

  [[nodiscard]] float next_1d();  // [0, 1), the next dimension
  [[nodiscard]] Vec2 next_2d();   // the next two dimensions, well distributed together
  // An independent continuation of this path: the k-th of the `count` trajectories that `--split`
  // makes from x_i; the points of all k together are well distributed too. index * count < 2^48.
  [[nodiscard]] Sampler split(std::uint32_t k, std::uint32_t count) const;

 private:
  [[nodiscard]] std::uint64_t
  take_key();  // of the scrambling of the next dimension, which it passes
  [[nodiscard]] bool from_sequence(std::uint32_t count) const;  // the next `count` dimensions

  SamplerKind kind_;
  bool global_;
  std::uint32_t dimension_ = 0;
  std::uint64_t seed_;  // hash of seed and sequence
  std::uint64_t index_;
};

// b of the (t, m, s)-nets: Metadata::block_base
[[nodiscard]] std::uint32_t block_base(SamplerKind kind);

}  // namespace psf::render
