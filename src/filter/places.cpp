#include "filter/places.h"

#include <algorithm>
#include <vector>

#include "core/parallel.h"

namespace psf::filter {

std::optional<std::size_t> first_misplaced(std::span<const std::uint32_t> pixel,
                                           std::span<const std::uint16_t> camera,
                                           std::span<const CameraView> cameras) {
  constexpr std::size_t kRecordsARange = 65536;
  const auto is_good = [&](std::size_t i) {
    const std::size_t k = camera.empty() ? 0 : camera[i];
    return k < cameras.size() && pixel[i] < std::uint64_t{cameras[k].width} * cameras[k].height;
  };
  const std::size_t count = pixel.size();
  std::vector<std::size_t> bad(core::range_count(count, kRecordsARange), count);
  core::parallel_for(count, kRecordsARange, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (is_good(i)) continue;
      bad[begin / kRecordsARange] = i;
      return;
    }
  });
  const auto first = std::find_if(bad.begin(), bad.end(), [&](std::size_t i) { return i < count; });
  return first == bad.end() ? std::nullopt : std::optional(*first);
}

}  // namespace psf::filter
