#include "report/report_picture.h"

#include <ImathConfig.h>
#include <half.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/error.h"

namespace psf::report {
namespace {

std::uint16_t half_bits(float value) {
  constexpr float kLargest = HALF_MAX;
  if (std::isfinite(value)) value = std::clamp(value, -kLargest, kLargest);
  return Imath::half(value).bits();
}

std::string deflated(const std::vector<std::uint8_t>& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string result(size, '\0');
  const int status = compress2(reinterpret_cast<Bytef*>(result.data()), &size, bytes.data(),
                               static_cast<uLong>(bytes.size()), Z_DEFAULT_COMPRESSION);
  if (status != Z_OK) throw Error(ErrorCode::limit, "a picture could not be deflated");
  result.resize(size);
  return result;
}

// RFC 4648.
std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - at);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < count; ++k) {
      bits |= std::uint32_t{static_cast<unsigned char>(bytes[at + k])} << (16 - 8 * k);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k > count ? '=' : kDigits[(bits >> (18 - 6 * k)) & 63];
    }
  }
  return text;
}

}  // namespace

EncodedPicture encode_picture(const film::Image& image) {
  const std::vector<Rgb> colors = image.seen();
  const std::size_t count = 3 * colors.size();
  std::vector<std::uint8_t> bytes(2 * count);
  std::size_t at = 0;
  for (int channel = 0; channel < 3; ++channel) {
    std::uint16_t left = 0, above = 0;
    for (std::size_t pixel = 0; pixel < colors.size(); ++pixel) {
      const std::uint16_t bits = half_bits(colors[pixel][channel]);
      const bool first_column = pixel % image.width == 0;
      const auto difference = static_cast<std::uint16_t>(bits - (first_column ? above : left));
      if (first_column) above = bits;
      left = bits;
      bytes[at] = static_cast<std::uint8_t>(difference & 0xff);
      bytes[count + at] = static_cast<std::uint8_t>(difference >> 8);
      ++at;
    }
  }
  return {image.width, image.height, base64(deflated(bytes))};
}

}  // namespace psf::report
