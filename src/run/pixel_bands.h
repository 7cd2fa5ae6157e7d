// Shares the pixels of a block's records among threads, so that sums by pixel are the same for any
// number of threads.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/parallel.h"
#include "filter/records.h"

namespace psf::run {

// Pixels are given to the bands in short runs, in turn. So two threads seldom write to one cache
// line, and the records of a small part of the picture still keep all threads busy.
inline constexpr std::uint32_t kPixelRun = 64;
inline constexpr std::size_t kMostBands = 32;

[[nodiscard]] inline std::size_t pixel_bands() {
  return std::bit_ceil(std::min(core::thread_count(), kMostBands));
}

// Calls visit(band, some) with the numbers of some of the records [first, last), the bands in
// parallel; band < pixel_bands(). The records of a pixel come in path order and from one band.
template <class Visit>
void for_each_by_pixel(const filter::Records& records, std::size_t first, std::size_t last,
                       const Visit& visit) {
  constexpr std::size_t kBatch = 1024;  // records
  const std::size_t bands = pixel_bands();
  core::parallel_for(bands, 1, [&](std::size_t band, std::size_t) {
    std::array<std::size_t, kBatch> mine;
    for (std::size_t begin = first; begin < last; begin += kBatch) {
      // There is no branch, because it would be mispredicted half of the time for paths in random
      // order.
      std::size_t count = 0;
      for (std::size_t i = begin, end = std::min(last, begin + kBatch); i < end; ++i) {
        mine[count] = i;
        count += ((records.pixel[i] / kPixelRun) & (bands - 1)) == band ? 1u : 0u;
      }
      visit(band, std::span<const std::size_t>(mine).first(count));
    }
  });
}

}  // namespace psf::run
