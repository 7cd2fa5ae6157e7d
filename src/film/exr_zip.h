// ZIP compression of the chunks of an EXR file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace psf::film {

// Compresses one chunk after another, and keeps its buffers from one to the next.
class ExrZip {
 public:
  // A buffer for the bytes of a chunk, which the caller fills; valid until the next call.
  [[nodiscard]] std::span<std::uint8_t> room(std::size_t bytes);
  // The bytes of room() as the file stores them: rearranged and deflated as in OpenEXR's technical
  // introduction, or unchanged where that does not make them fewer. Valid until the next call of
  // room(). The result is the same for one kind of processor.
  [[nodiscard]] std::span<const std::uint8_t> zip();

 private:
  std::size_t size_ = 0, reserved_ = 0;
  // Not vectors, which would be set to 0 first.
  std::unique_ptr<std::uint8_t[]> plain_, rearranged_, zipped_, level_buffer_;
};

}  // namespace psf::film
