// The partition of a dump's paths into blocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "filter/parameters/parameters.h"

namespace psf::filter {

inline constexpr std::uint64_t kMostPaths = (std::uint64_t{1} << 31) - 1;  // of a block

struct PathRange {
  std::uint64_t first = 0, last = 0;  // [first, last)
  [[nodiscard]] std::uint64_t size() const { return last - first; }
  bool operator==(const PathRange&) const = default;
};

// The blocks of a range of passes. Blocks of b^m paths begin at multiples of b^m, counted from the
// first path of the dump, so that they are nets of the sampling sequence; they are cut where the
// range begins and ends. Blocks of K passes are counted from the range's first pass. The last block
// may be short.
class Blocks {
 public:
  // pass_bounds[p] is the first path of pass p; one more entry is the end of the last pass. The
  // range is the passes [first_pass, last_pass). Throws Error{limit} where a block has more than
  // 2^31 - 1 paths.
  Blocks(const BlockSize& size, std::vector<std::uint64_t> pass_bounds, std::size_t first_pass,
         std::size_t last_pass);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] PathRange operator[](std::uint64_t k) const;
  [[nodiscard]] PathRange all() const { return all_; }
  // Whether more passes would leave block k as it is.
  [[nodiscard]] bool is_whole(std::uint64_t k) const;

 private:
  BlockSize size_;
  std::vector<std::uint64_t> bounds_;
  std::size_t first_pass_, last_pass_;
  PathRange all_;
  std::uint64_t length_ = 0;  // for blocks of b^m paths: b^m, or a number above that of all paths
  std::uint64_t count_ = 0;
};

}  // namespace psf::filter
