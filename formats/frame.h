// Frames: the 64 bytes that every one starts with, and its directory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/file.h"
#include "formats/head.h"

namespace psf::formats {

struct Prefix {
  Uuid uuid{};
  std::uint32_t type = 0, flags = 0;
  std::uint64_t offset = 0, length = 0, sequence = 0;
};

struct Frame {
  Prefix prefix;
  std::vector<std::byte> directory;

  [[nodiscard]] std::uint64_t end() const { return prefix.offset + prefix.length; }
};

// Prefix and directory with their checksum: what stands at the start of the frame.
[[nodiscard]] std::vector<std::byte> encode_front(const Prefix& prefix,
                                                  std::span<const std::byte> directory);

enum class FrameState {
  whole,
  cut,  // plausible, but the file ends before it does
  bad   // no frame of this file stands here
};

struct FrameResult {
  FrameState state = FrameState::bad;
  Frame frame;        // where whole
  std::string fault;  // where not: why
};

// Reads and checks the front of the frame at `offset` of a file of `file_size` bytes; of the file
// `uuid`, or of any where null. Throws only Error{io}.
[[nodiscard]] FrameResult read_frame(const File& file, std::uint64_t file_size,
                                     std::uint64_t offset, const Uuid* uuid);

// "CHNK"; bytes that are no printable characters become '?'.
[[nodiscard]] std::string type_name(std::uint32_t type);

}  // namespace psf::formats
