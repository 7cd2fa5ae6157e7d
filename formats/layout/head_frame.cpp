#include "formats/layout/head_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>

#include "core/error.h"
#include "formats/layout/bytes.h"
#include "formats/layout/layout.h"

namespace psf::formats {
namespace {

Channel decode_channel(ByteReader& in) {
  const std::span<const std::byte> bytes = in.get_bytes(kChannelName);
  const std::string_view name(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  Channel channel;
  channel.name = name.substr(0, name.find('\0'));
  if (name.find_first_not_of('\0', channel.name.size()) != std::string_view::npos) {
    throw Error(ErrorCode::bad_input, "HEAD: a channel's name is not padded with zeros");
  }
  // A value out of range is found by validate().
  channel.type = static_cast<Type>(in.get<std::uint8_t>());
  channel.components = in.get<std::uint8_t>();
  channel.encoding = static_cast<Encoding>(in.get<std::uint8_t>());
  in.skip(kChannelEntry - kChannelName - 3);
  return channel;
}

[[noreturn]] void refuse_layout(const Head& head, const std::string& why) {
  throw Error(ErrorCode::bad_input,
              fmt::format("written by version {}.{} of the format, {}; this program reads version "
                          "{}: use a newer one",
                          head.major, head.minor, why, kMajor));
}

}  // namespace

std::vector<std::byte> encode_head(const Head& head) {
  ByteWriter out;
  out.put(head.major);
  out.put(head.minor);
  out.put(head.required_features);
  out.put(head.optional_features);
  out.put(head.chunk_capacity);
  out.put(static_cast<std::uint32_t>(head.channels.size()));
  out.put(static_cast<std::uint32_t>(head.metadata.size()));
  out.put_bytes(head.later_fields);
  for (const Channel& channel : head.channels) {
    out.put_bytes(std::as_bytes(std::span(channel.name)));
    out.put_zeros(kChannelName - channel.name.size());
    out.put(static_cast<std::uint8_t>(channel.type));
    out.put(channel.components);
    out.put(static_cast<std::uint8_t>(channel.encoding));
    out.put_zeros(kChannelEntry - kChannelName - 3);
  }
  out.put_bytes(std::as_bytes(std::span(head.metadata)));
  out.put_bytes(head.later_bytes);
  return out.take();
}

Head decode_head(std::span<const std::byte> directory) {
  ByteReader in(directory);
  Head head;
  head.channels.clear();
  head.major = in.get<std::uint16_t>();
  head.minor = in.get<std::uint16_t>();
  if (head.major != kMajor) refuse_layout(head, "whose layout is another");
  head.required_features = in.get<std::uint32_t>();
  if (const std::uint32_t unknown = head.required_features & ~kKnownRequiredFeatures) {
    refuse_layout(head, fmt::format("with features that must be understood to read it (bits {:#x})",
                                    unknown));
  }
  head.optional_features = in.get<std::uint32_t>();
  head.chunk_capacity = in.get<std::uint32_t>();
  const std::size_t channels = in.get<std::uint32_t>();
  const std::size_t metadata = in.get<std::uint32_t>();
  if (channels > kMaxChannels || metadata > kMaxMetadata) {
    throw Error(ErrorCode::limit,
                fmt::format("HEAD: {} channels (at most {}), {} bytes of metadata (at most {})",
                            channels, kMaxChannels, metadata, kMaxMetadata));
  }
  std::ranges::copy(in.get_bytes(head.later_fields.size()), head.later_fields.begin());
  for (std::size_t k = 0; k < channels; ++k) head.channels.push_back(decode_channel(in));
  const std::span<const std::byte> text = in.get_bytes(metadata);
  head.metadata.assign(reinterpret_cast<const char*>(text.data()), text.size());
  const std::span<const std::byte> rest = in.rest();
  head.later_bytes.assign(rest.begin(), rest.end());
  validate(head);
  return head;
}

std::string to_text(const Uuid& uuid) {
  std::string text;
  for (std::size_t k = 0; k < uuid.size(); ++k) {
    if (k == 4 || k == 6 || k == 8 || k == 10) text += '-';
    text += fmt::format("{:02x}", uuid[k]);
  }
  return text;
}

Uuid make_uuid() {
  std::random_device device;
  Uuid uuid;
  std::generate(uuid.begin(), uuid.end(),
                [&] { return static_cast<std::uint8_t>(device() & 0xFF); });
  uuid[6] = static_cast<std::uint8_t>((uuid[6] & 0x0F) | 0x40);
  uuid[8] = static_cast<std::uint8_t>((uuid[8] & 0x3F) | 0x80);
  return uuid;
}

}  // namespace psf::formats
