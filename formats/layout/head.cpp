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

std::string to_text(const Table& table) {
  std::string channels;
  for (const Channel& channel : table.channels) {
    channels += (channels.empty() ? "" : ", ") + to_text(channel);
  }
  return fmt::format("{} ({})", table.name, channels);
}

bool is_required_channel(std::string_view name) {
  const ChannelInfo* channel = channel_info(name);
  return channel != nullptr && channel->required;
}

std::optional<std::size_t> Schema::find(std::string_view channel) const {
  for (std::size_t k = 0; k < channels.size(); ++k) {
    if (channels[k].name == channel) return k;
  }
  return std::nullopt;
}

std::size_t Schema::stride() const {
  std::size_t bytes = 0;
  for (const Channel& channel : channels) bytes += channel.stride();
  return bytes;
}

const Schema& Head::schema(std::size_t table) const {
  if (table == 0) return *this;
  return tables.at(table - 1);
}

std::string_view Head::table_name(std::size_t table) const {
  return table == 0 ? kPaths : std::string_view(tables.at(table - 1).name);
}

std::optional<std::size_t> Head::find_table(std::string_view name) const {
  for (std::size_t k = 0; k < table_count(); ++k) {
    if (table_name(k) == name) return k;
  }
  return std::nullopt;
}

namespace {

[[noreturn]] void refuse_head(ErrorCode code, const std::string& why) {
  throw Error(code, why);
}

bool is_printable(std::string_view name) {
  return std::all_of(name.begin(), name.end(), [](char c) { return c > ' ' && c <= '~'; });
}

void validate_name(std::string_view name, std::string_view whose) {
  if (!name.empty() && name.size() <= kChannelName && is_printable(name)) return;
  refuse_head(ErrorCode::bad_input,
              fmt::format("a {}'s name must be 1 to {} printable ASCII characters without spaces",
                          whose, kChannelName));
}

void validate(const Channel& channel) {
  validate_name(channel.name, "channel");
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

void validate(const Schema& schema) {
  if (schema.channels.empty() || schema.channels.size() > kMaxChannels) {
    refuse_head(ErrorCode::bad_input, fmt::format("{} channels; 1 to {} are possible",
                                                  schema.channels.size(), kMaxChannels));
  }
  std::set<std::string_view> names;
  for (const Channel& channel : schema.channels) {
    validate(channel);
    if (!names.insert(channel.name).second) {
      refuse_head(ErrorCode::bad_input, fmt::format("channel {} is declared twice", channel.name));
    }
  }
  if (schema.chunk_capacity < 1 || schema.chunk_capacity > kMaxChunkRecords ||
      schema.chunk_capacity * std::uint64_t{schema.stride()} > kMaxChunkBytes) {
    refuse_head(
        ErrorCode::limit,
        fmt::format("chunks of {} records of {} bytes; a chunk has 1 to {} records and at most "
                    "{} MiB",
                    schema.chunk_capacity, schema.stride(), kMaxChunkRecords,
                    kMaxChunkBytes >> 20));
  }
}

void validate_tables(const Head& head) {
  if (head.tables.size() > kMaxTables) {
    refuse_head(ErrorCode::bad_input,
                fmt::format("{} tables; at most {} are possible", head.tables.size(), kMaxTables));
  }
  std::set<std::string_view> names = {kPaths};
  for (const Table& table : head.tables) {
    validate_name(table.name, "table");
    if (!names.insert(table.name).second) {
      refuse_head(ErrorCode::bad_input, fmt::format("table {} is declared twice", table.name));
    }
    try {
      validate(static_cast<const Schema&>(table));
    } catch (const Error& error) {
      refuse_head(error.code(), fmt::format("table {}: {}", table.name, error.what()));
    }
  }
}

}  // namespace

void validate(const Head& head) {
  if (head.major != kMajor || (head.required_features & ~kKnownRequiredFeatures) != 0) {
    refuse_head(ErrorCode::bad_input, "the head asks for features that version 1 does not have");
  }
  validate(static_cast<const Schema&>(head));
  validate_tables(head);
  if (head.metadata.size() > kMaxMetadata) {
    refuse_head(ErrorCode::limit, fmt::format("{} bytes of metadata; at most {} are possible",
                                              head.metadata.size(), kMaxMetadata));
  }
}

}  // namespace psf::formats
