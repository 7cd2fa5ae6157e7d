#include "formats/layout/crc.h"

#include <isa-l/crc.h>

namespace psf::formats {

// ISA-L's, because it folds 64 bytes at a time where the processor can: 59 GB/s where 16 at a time
// (libdeflate 1.14) make 22, which decides whether reading keeps up with pread (chunk.cpp).
std::uint32_t crc32(std::uint32_t before, std::span<const std::byte> bytes) {
  return crc32_gzip_refl(before, reinterpret_cast<const unsigned char*>(bytes.data()),
                         bytes.size());
}

}  // namespace psf::formats
