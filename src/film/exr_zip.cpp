#include "film/exr_zip.h"

#include <isa-l/igzip_lib.h>

#include <cstddef>

namespace psf::film {
namespace {

// The even bytes, then the odd ones, each as 128 more than the difference to the one before it.
std::vector<std::uint8_t> rearranged(const std::vector<std::uint8_t>& bytes) {
  const std::size_t count = bytes.size(), half = (count + 1) / 2;
  std::vector<std::uint8_t> result(count);
  const auto difference = [&](std::size_t now, std::size_t before) {
    return static_cast<std::uint8_t>(bytes[now] - bytes[before] + 128);
  };
  if (count > 0) result[0] = bytes[0];
  if (count > 1) result[half] = difference(1, 2 * half - 2);
  for (std::size_t i = 1; i < half; ++i) result[i] = difference(2 * i, 2 * i - 2);
  for (std::size_t i = 1; i < count / 2; ++i) result[half + i] = difference(2 * i + 1, 2 * i - 1);
  return result;
}

}  // namespace

// Level 1 of ISA-L takes a tenth of the time of zlib's, which OpenEXR would use, for files 1% to 3%
// longer; its higher levels take longer and do not make these files smaller.
std::vector<std::uint8_t> exr_zip(std::vector<std::uint8_t> bytes) {
  std::vector<std::uint8_t> input = rearranged(bytes);
  std::vector<std::uint8_t> level_buffer(ISAL_DEF_LVL1_DEFAULT);
  std::vector<std::uint8_t> output(bytes.size());
  isal_zstream stream;
  isal_deflate_stateless_init(&stream);
  stream.level = 1;
  stream.level_buf = level_buffer.data();
  stream.level_buf_size = static_cast<std::uint32_t>(level_buffer.size());
  stream.gzip_flag = IGZIP_ZLIB;
  stream.end_of_stream = 1;
  stream.next_in = input.data();
  stream.avail_in = static_cast<std::uint32_t>(input.size());
  stream.next_out = output.data();
  stream.avail_out = static_cast<std::uint32_t>(output.size());
  if (isal_deflate_stateless(&stream) != COMP_OK || stream.total_out >= bytes.size()) return bytes;
  return {output.begin(), output.begin() + static_cast<std::ptrdiff_t>(stream.total_out)};
}

}  // namespace psf::film
