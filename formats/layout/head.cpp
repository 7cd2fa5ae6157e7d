#include "formats/layout/head.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/error.h"
#include "formats/layout/channels.h"
#include "formats/layout/layout.h"

namespace psf::formats {

std::size_t size_of(Type type) {
  switch (type) {
    case Type::u8:
      return 1;
    case Type::f16:
    case Type::u16:
      return 2;
    case Type::u32:
    case Type::f32:
      return 4;
    case Type::u64:
    case Type::f64:
      return 8;
  }
  return 0;
}

std::string_view name_of(Type type) {
  switch (type) {
    case Type::u8:
      return "u8";
    case Type::u16:
      return "u16";
    case Type::u32:
      return "u32";
    case Type::u64:
      return "u64";
    case Type::f16:
      return "f16";
    case Type::f32:
      return "f32";
    case Type::f64:
      return "f64";
  }
  return "?";
}

std::string to_text(const Channel& channel) {
  return fmt::format("{} {} x {}{}", channel.name, name_of(channel.type), channel.components,
                     channel.encoding == Encoding::octahedral ? " octahedral" : "");
}

bool is_required_channel(std::string_view name) {
  const ChannelInfo* channel = channel_info(name);
  return channel != nullptr && channel->required;
}

std::optional<std::size_t> Head::find(std::string_view channel) const {
  for (std::size_t k = 0; k < channels.size(); ++k) {
    if (channels[k].name == channel) return k;
  }
  return std::nullopt;
}

std::size_t Head::stride() const {
  std::size_t bytes = 0;
  for (const Channel& channel : channels) bytes += channel.stride();
  return bytes;
}

namespace {

[[noreturn]] void refuse_head(ErrorCode code, const std::string& why) {
  throw Error(code, why);
}

bool is_printable(std::string_view name) {
  return std::all_of(name.begin(), name.end(), [](char c) { return c > ' ' && c <= '~'; });
}

void validate(const Channel& channel) {
  if (channel.name.empty() || channel.name.size() > kChannelName || !is_printable(channel.name)) {
    refuse_head(
        ErrorCode::bad_input,
        fmt::format("a channel's name must be 1 to {} printable ASCII characters without spaces",
                    kChannelName));
  }
  if (size_of(channel.type) == 0) {
    refuse_head(ErrorCode::bad_input, fmt::format("channel {}: unknown type {}", channel.name,
                                                  static_cast<int>(channel.type)));
  }
  if (channel.components < 1 || channel.components > kMaxComponents) {
    refuse_head(ErrorCode::bad_input,
                fmt::format("channel {}: {} components; 1 to {} are possible", channel.name,
                            channel.components, kMaxComponents));
  }
  if (channel.encoding == Encoding::plain) return;
  if (channel.encoding != Encoding::octahedral) {
    refuse_head(ErrorCode::bad_input, fmt::format("channel {}: unknown encoding {}", channel.name,
                                                  static_cast<int>(channel.encoding)));
  }
  if (channel.type != Type::u16 || channel.components != 2) {
    refuse_head(ErrorCode::bad_input,
                fmt::format("channel {}: an octahedral channel is u16 x 2", channel.name));
  }
}

}  // namespace

void validate(const Head& head) {
  if (head.major != kMajor || (head.required_features & ~kKnownRequiredFeatures) != 0) {
    refuse_head(ErrorCode::bad_input, "the head asks for features that version 1 does not have");
  }
  if (head.channels.empty() || head.channels.size() > kMaxChannels) {
    refuse_head(ErrorCode::bad_input, fmt::format("{} channels; 1 to {} are possible",
                                                  head.channels.size(), kMaxChannels));
  }
  std::set<std::string_view> names;
  for (const Channel& channel : head.channels) {
    validate(channel);
    if (!names.insert(channel.name).second) {
      refuse_head(ErrorCode::bad_input, fmt::format("channel {} is declared twice", channel.name));
    }
  }
  if (head.chunk_capacity < 1 || head.chunk_capacity > kMaxChunkRecords ||
      head.chunk_capacity * std::uint64_t{head.stride()} > kMaxChunkBytes) {
    refuse_head(
        ErrorCode::limit,
        fmt::format("chunks of {} records of {} bytes; a chunk has 1 to {} records and at most "
                    "{} MiB",
                    head.chunk_capacity, head.stride(), kMaxChunkRecords, kMaxChunkBytes >> 20));
  }
  if (head.metadata.size() > kMaxMetadata) {
    refuse_head(ErrorCode::limit, fmt::format("{} bytes of metadata; at most {} are possible",
                                              head.metadata.size(), kMaxMetadata));
  }
}

}  // namespace psf::formats
