// Chooses the paths to shade where one in K is shaded: a lattice over the pixels that moves from
// pass to pass.
#pragma once

#include <cstdint>

namespace psf::render {

inline constexpr std::uint32_t kMostShadeRate = 65536;

// The path of pixel (x, y) in a pass is shaded where x + b y + c pass = 0 (mod K). Any K neighbours
// in a row hold one shaded path, and any K passes shade each pixel once. b puts the shaded pixels
// of a pass as far apart as a lattice can, and c sends consecutive passes to distant residues.
class ShadeRate {
 public:
  explicit ShadeRate(std::uint32_t k);  // 1 to kMostShadeRate
  [[nodiscard]] bool shaded(std::uint32_t x, std::uint32_t y, std::uint64_t pass) const {
    return k_ == 1 || (x + std::uint64_t{b_} * y + c_ * (pass % k_)) % k_ == 0;
  }

 private:
  std::uint32_t k_, b_, c_;
};

}  // namespace psf::render
