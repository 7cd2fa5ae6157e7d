// Frames: the prefix of 64 bytes with which every frame starts, and its directory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/layout/file.h"
#include "formats/layout/head.h"

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

// The start of a frame: prefix and directory, with their checksum.
[[nodiscard]] std::vector<std::byte> encode_front(const Prefix& prefix,
                                                  std::span<const std::byte> directory);

enum class FrameState {
  whole,
  cut,  // plausible, but the file ends before the frame
  bad   // there is no frame of this file
};

struct FrameResult {
  FrameState state = FrameState::bad;
  Frame frame;        // set where the state is `whole`
  std::string fault;  // else the reason
};

// Reads and checks prefix and directory of the frame at `offset` in a file of `file_size` bytes.
// The frame must have the given uuid, or any where `uuid` is null. Throws only Error{io}.
[[nodiscard]] FrameResult read_frame(const File& file, std::uint64_t file_size,
                                     std::uint64_t offset, const Uuid* uuid);

// The type as text, such as "CHNK"; bytes that are not printable become '?'.
[[nodiscard]] std::string type_name(std::uint32_t type);

}  // namespace psf::formats
