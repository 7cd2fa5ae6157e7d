#include "formats/layout/head_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>

#include "core/error.h"
#include "formats/layout/bytes.h"
#include "formats/layout/layout.h"

namespace psf::formats {
namespace {

void encode_name(std::string_view name, ByteWriter& out) {
  out.put_bytes(std::as_bytes(std::span(name)));
  out.put_zeros(kChannelName - name.size());
}

std::string decode_name(ByteReader& in, std::string_view whose) {
  const std::span<const std::byte> bytes = in.get_bytes(kChannelName);
  const std::string_view padded(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string_view name = padded.substr(0, padded.find('\0'));
  if (padded.find_first_not_of('\0', name.size()) != std::string_view::npos) {
    throw Error(ErrorCode::bad_input,
                fmt::format("HEAD: a {}'s name is not padded with zeros", whose));
  }
  return std::string(name);
}

void encode_channels(std::span<const Channel> channels, ByteWriter& out) {
  for (const Channel& channel : channels) {
    encode_name(channel.name, out);
    out.put(static_cast<std::uint8_t>(channel.type));
    out.put(channel.components);
    out.put(static_cast<std::uint8_t>(channel.encoding));
    out.put_zeros(kChannelEntry - kChannelName - 3);
  }
}

Channel decode_channel(ByteReader& in) {
  Channel channel;
  channel.name = decode_name(in, "channel");
  // A value out of range is found by validate().
  channel.type = static_cast<Type>(in.get<std::uint8_t>());
  channel.components = in.get<std::uint8_t>();
  channel.encoding = static_cast<Encoding>(in.get<std::uint8_t>());
  in.skip(kChannelEntry - kChannelName - 3);
  return channel;
}

void encode_tables(std::span<const Table> tables, ByteWriter& out) {
  out.put(static_cast<std::uint32_t>(tables.size()));
  out.put_zeros(4);
  for (const Table& table : tables) {
    encode_name(table.name, out);
    out.put(table.chunk_capacity);
    out.put(static_cast<std::uint32_t>(table.channels.size()));
    encode_channels(table.channels, out);
  }
}

std::vector<Table> decode_tables(ByteReader& in) {
  const std::size_t count = in.get<std::uint32_t>();
  in.skip(4);
  if (count < 1 || count > kMaxTables) {
    throw Error(ErrorCode::limit,
                fmt::format("HEAD: {} tables; 1 to {} are possible", count, kMaxTables));
  }
  std::vector<Table> tables(count);
  for (Table& table : tables) {
    table.name = decode_name(in, "table");
    table.chunk_capacity = in.get<std::uint32_t>();
    const std::size_t channels = in.get<std::uint32_t>();
    if (channels > kMaxChannels) {
      throw Error(ErrorCode::limit,
                  fmt::format("HEAD: a table of {} channels; at most {}", channels, kMaxChannels));
    }
    for (std::size_t k = 0; k < channels; ++k) table.channels.push_back(decode_channel(in));
  }
  return tables;
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
  out.put(head.tables.empty() ? head.minor : std::max(head.minor, kMinor));
  out.put(head.required_features);
  const std::uint32_t others = head.optional_features & ~kTablesFeature;
  out.put(others | (head.tables.empty() ? 0 : kTablesFeature));
  out.put(head.chunk_capacity);
  out.put(static_cast<std::uint32_t>(head.channels.size()));
  out.put(static_cast<std::uint32_t>(head.metadata.size()));
  out.put_bytes(head.later_fields);
  encode_channels(head.channels, out);
  out.put_bytes(std::as_bytes(std::span(head.metadata)));
  if (!head.tables.empty()) encode_tables(head.tables, out);
  out.put_bytes(head.later_bytes);
  return out.take();
}

Head decode_head(std::span<const std::byte> directory) {
  ByteReader in(directory, "HEAD's directory ");
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
  if ((head.optional_features & kTablesFeature) != 0) {
    head.tables = decode_tables(in);
    head.optional_features &= ~kTablesFeature;  // `tables` say it, and nothing else
  }
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
