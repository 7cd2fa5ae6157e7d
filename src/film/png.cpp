// PNG through libpng: 8 bits, tone-mapped, sRGB.
#include <png.h>

#include <cassert>
#include <cmath>

#include "core/error.h"
#include "core/output_file.h"
#include "film/display.h"
#include "film/image.h"

namespace psf::film {
namespace {

// (height, width, 3) sRGB.
std::vector<std::uint8_t> displayed(const Image& image, float exposure) {
  const std::vector<Rgb> colors = image.seen();
  const float scale = std::exp2(exposure);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(3 * colors.size());
  for (const Rgb& color : colors) {
    for (const float component : {color.x, color.y, color.z}) {
      bytes.push_back(displayed_byte(component * scale));
    }
  }
  return bytes;
}

png_image described(std::size_t width, std::size_t height) {
  png_image picture = {};
  picture.version = PNG_IMAGE_VERSION;
  picture.width = static_cast<png_uint_32>(width);
  picture.height = static_cast<png_uint_32>(height);
  picture.format = PNG_FORMAT_RGB;
  return picture;
}

}  // namespace

void write_png(const std::string& path, const Image& image, float exposure) {
  write_png_bytes(path, image.width, image.height, displayed(image, exposure));
}

std::vector<std::uint8_t> encode_png(const Image& image, float exposure) {
  return encode_png_bytes(image.width, image.height, displayed(image, exposure));
}

std::vector<std::uint8_t> encode_png_bytes(std::size_t width, std::size_t height,
                                           std::span<const std::uint8_t> bytes) {
  assert(bytes.size() == 3 * width * height);
  png_image picture = described(width, height);
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(picture);
  std::vector<std::uint8_t> file(size);
  if (png_image_write_to_memory(&picture, file.data(), &size, 0, bytes.data(), 0, nullptr) == 0) {
    throw Error(ErrorCode::io, std::string("cannot encode the picture: ") + picture.message);
  }
  file.resize(size);
  return file;
}

void write_png_bytes(const std::string& path, std::size_t width, std::size_t height,
                     std::span<const std::uint8_t> bytes) {
  const std::vector<std::uint8_t> file = encode_png_bytes(width, height, bytes);
  core::write_text_file(path, std::string(file.begin(), file.end()));
}

}  // namespace psf::film
