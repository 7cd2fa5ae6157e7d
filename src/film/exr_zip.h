// The ZIP compression of an EXR's chunk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace psf::film {

// Room for the bytes of one chunk after another, and for what they become.
class ExrZip {
 public:
  // Bytes that the caller fills; they are lost with the next call.
  [[nodiscard]] std::span<std::uint8_t> room(std::size_t bytes);
  // The bytes of room() as the file holds them: deflated as OpenEXR's technical introduction has
  // it, or as they are where that does not make them fewer; until the next call of room(). The same
  // bytes for one kind of processor.
  [[nodiscard]] std::span<const std::uint8_t> zip();

 private:
  std::size_t size_ = 0, reserved_ = 0;
  // Not vectors, which would be set to 0 first.
  std::unique_ptr<std::uint8_t[]> plain_, rearranged_, zipped_, level_buffer_;
};

}  // namespace psf::film
