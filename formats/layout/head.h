// HEAD: the version, features, channels, tables and metadata of a path-vertex buffer.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace psf::formats {

// The identifier of a file, which every frame has.
using Uuid = std::array<std::uint8_t, 16>;

// The scalar type of a stored component; the numbers are those in the file.
enum class Type : std::uint8_t { u8 = 1, u16 = 2, u32 = 3, u64 = 4, f16 = 5, f32 = 6, f64 = 7 };

[[nodiscard]] std::size_t size_of(Type type);
[[nodiscard]] std::string_view name_of(Type type);

// plain: the components are the value. octahedral: two u16 encode a unit vector of three f32.
enum class Encoding : std::uint8_t { plain = 0, octahedral = 1 };

struct Channel {
  std::string name;
  Type type = Type::f32;
  std::uint8_t components = 1;  // 1 to 16, as stored
  Encoding encoding = Encoding::plain;

  [[nodiscard]] std::size_t stride() const {
    return size_of(type) * components;
  }  // stored bytes per record
  // Components of the value that a reader gets as floats: 3 for an octahedral channel.
  [[nodiscard]] std::size_t decoded_components() const {
    return encoding == Encoding::octahedral ? 3 : components;
  }
  bool operator==(const Channel&) const = default;
};

// What each record of the paths, or of a table, holds.
struct Schema {
  std::uint32_t chunk_capacity = 65536;  // most records per chunk, 1 to 2^24
  std::vector<Channel> channels;         // 1 to 256, unique names

  [[nodiscard]] std::optional<std::size_t> find(std::string_view channel) const;
  [[nodiscard]] std::size_t stride() const;  // stored bytes per record, all channels
  bool operator==(const Schema&) const = default;
};

// Records beside the paths, under the same passes: README.md, "Tables".
struct Table : Schema {
  std::string name;
  bool operator==(const Table&) const = default;
};

// The name by which the records of the paths are asked for; no table has it.
inline constexpr std::string_view kPaths = "paths";

// The schema is that of the paths.
struct Head : Schema {
  std::uint16_t major = 1;
  std::uint16_t minor = 0;
  std::uint32_t required_features = 0;
  std::uint32_t optional_features = 0;
  std::string metadata = "{}";  // a JSON object, UTF-8, at most 1 MiB; see metadata.h
  std::vector<Table> tables;    // at most 16, unique names; with any, the file is of version 1.1
  // HEAD's 40 reserved bytes and the bytes behind metadata and tables, where later minor versions
  // may put values. They mean nothing here and are kept when copying.
  std::array<std::byte, 40> later_fields{};
  std::vector<std::byte> later_bytes;

  // Tables by number: the paths are 0, `tables` follow from 1 on.
  [[nodiscard]] std::size_t table_count() const { return 1 + tables.size(); }
  [[nodiscard]] const Schema& schema(std::size_t table) const;
  [[nodiscard]] std::string_view table_name(std::size_t table) const;
  [[nodiscard]] std::optional<std::size_t> find_table(std::string_view name) const;
};

// A channel as text: "normal u16 x 2 octahedral".
[[nodiscard]] std::string to_text(const Channel& channel);

// A table as text: "vertices (path u32 x 1, position f32 x 3)".
[[nodiscard]] std::string to_text(const Table& table);

// Whether every dump must have the channel: README.md, "Channels".
[[nodiscard]] bool is_required_channel(std::string_view name);

// Throws Error{bad_input} that says which limit or rule of version 1 the head breaks (the caller
// adds the file).
void validate(const Head& head);

}  // namespace psf::formats
