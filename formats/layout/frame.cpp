#include "formats/layout/frame.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "formats/layout/bytes.h"
#include "formats/layout/crc.h"
#include "formats/layout/layout.h"

namespace psf::formats {
namespace {

constexpr std::size_t kChecked = kPrefix - 4;  // the checksum is the last field of the prefix

FrameResult not_whole(FrameState state, const char* fault) {
  return {state, {}, fault};
}

}  // namespace

std::vector<std::byte> encode_front(const Prefix& prefix, std::span<const std::byte> directory) {
  ByteWriter out;
  out.put_bytes(std::as_bytes(std::span(kMagic)));
  out.put_bytes(std::as_bytes(std::span(prefix.uuid)));
  out.put(prefix.type);
  out.put(prefix.flags);
  out.put(prefix.offset);
  out.put(prefix.length);
  out.put(prefix.sequence);
  out.put(static_cast<std::uint32_t>(directory.size()));
  out.put(crc32(crc32(out.bytes()), directory));
  out.put_bytes(directory);
  return out.take();
}

FrameResult read_frame(const File& file, std::uint64_t file_size, std::uint64_t offset,
                       const Uuid* uuid) {
  if (offset >= file_size || file_size - offset < kPrefix) {
    return not_whole(FrameState::cut, "the file ends within the first bytes of a frame");
  }
  const std::uint64_t available = file_size - offset;
  // Nearly every directory lies in the first page: one read for both.
  std::array<std::byte, kPage> page;
  const std::size_t got = static_cast<std::size_t>(std::min<std::uint64_t>(kPage, available));
  file.read_at(offset, std::span(page).first(got));

  if (std::memcmp(page.data(), kMagic.data(), kMagic.size()) != 0) {
    return not_whole(FrameState::bad, "no frame starts here");
  }
  FrameResult result;
  Prefix& prefix = result.frame.prefix;
  ByteReader in(std::span<const std::byte>(page).first(kPrefix));
  in.skip(kMagic.size());
  std::memcpy(prefix.uuid.data(), in.get_bytes(prefix.uuid.size()).data(), prefix.uuid.size());
  prefix.type = in.get<std::uint32_t>();
  prefix.flags = in.get<std::uint32_t>();
  prefix.offset = in.get<std::uint64_t>();
  prefix.length = in.get<std::uint64_t>();
  prefix.sequence = in.get<std::uint64_t>();
  const std::size_t directory_length = in.get<std::uint32_t>();
  const std::uint32_t expected = in.get<std::uint32_t>();

  if (uuid != nullptr && prefix.uuid != *uuid) {
    return not_whole(FrameState::bad, "a frame of another file stands here");
  }
  if (prefix.offset != offset) {
    return not_whole(FrameState::bad, "a frame from another place of the file stands here");
  }
  if (prefix.length % kPage != 0 || prefix.length < kPrefix || directory_length > kMaxDirectory ||
      directory_length > prefix.length - kPrefix) {
    return not_whole(FrameState::bad, "the lengths in the frame's first bytes are impossible");
  }
  if (directory_length > available - kPrefix) {
    return not_whole(FrameState::cut, "the file ends within the frame's directory");
  }
  std::vector<std::byte>& directory = result.frame.directory;
  directory.resize(directory_length);
  const std::size_t here = std::min(directory_length, got - kPrefix);
  std::copy_n(page.begin() + kPrefix, here, directory.begin());
  if (here < directory_length) {
    file.read_at(offset + kPrefix + here, std::span(directory).subspan(here));
  }
  const std::uint32_t front = crc32(std::span<const std::byte>(page).first(kChecked));
  if (!crc_matches(crc32(front, directory), expected)) {
    return not_whole(FrameState::bad, "checksum of the frame's first bytes and directory is wrong");
  }
  if (prefix.length > available) {
    return not_whole(FrameState::cut, "the file ends within the frame");
  }
  result.state = FrameState::whole;
  return result;
}

std::string type_name(std::uint32_t type) {
  std::string name;
  for (int k = 0; k < 4; ++k) {
    const char c = static_cast<char>(type >> (8 * k) & 0xFF);
    name += c > ' ' && c <= '~' ? c : '?';
  }
  return name;
}

}  // namespace psf::formats
