#include "formats/crc.h"

#include <libdeflate.h>

namespace psf::formats {

std::uint32_t crc32(std::uint32_t before, std::span<const std::byte> bytes) {
  // libdeflate restarts at 0 when it is given a null pointer.
  if (bytes.empty()) return before;
  return libdeflate_crc32(before, bytes.data(), bytes.size());
}

}  // namespace psf::formats
