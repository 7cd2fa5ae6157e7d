#include "formats/write/joined_head.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "formats/layout/layout.h"
#include "formats/layout/metadata.h"

namespace psf::formats {
namespace {

using Json = nlohmann::json;

// Metadata that paths of the same picture may differ in.
constexpr std::array<std::string_view, 6> kFree = {"producer", "seed",  "sampler",
                                                   "split",    "scene", "joined"};
constexpr const char* kMaterials = "materials";

template <class List>
bool has(const List& list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

[[noreturn]] void refuse_to_join(const Reader& reader, const Reader& first,
                                 const std::string& why) {
  throw Error(ErrorCode::bad_input,
              fmt::format("{}: cannot be joined with {}: {}", reader.path(), first.path(), why));
}

Json metadata_of(const Reader& reader) {
  try {
    static_cast<void>(parse_metadata(reader.head().metadata));
    return Json::parse(reader.head().metadata);
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("{}: {}", reader.path(), error.what()));
  }
}

// The first channel in which two lists differ, "as number 2 flags u8 x 1, not none"; empty: they do
// not.
std::string difference(const std::vector<Channel>& own, const std::vector<Channel>& other) {
  const auto [a, b] = std::mismatch(own.begin(), own.end(), other.begin(), other.end());
  if (a == own.end() && b == other.end()) return "";
  return fmt::format("as number {} {}, not {}", a - own.begin(),
                     a == own.end() ? "none" : to_text(*a),
                     b == other.end() ? "none" : to_text(*b));
}

// The first difference of two files in their tables; empty: there is none. How many records a chunk
// may have is none.
std::string difference(const std::vector<Table>& own, const std::vector<Table>& other) {
  for (std::size_t k = 0; k < own.size() || k < other.size(); ++k) {
    if (k >= own.size()) return fmt::format("it has no table {}", other[k].name);
    if (k >= other.size())
      return fmt::format("it has a table {}, which the other has not", own[k].name);
    if (own[k].name != other[k].name) {
      return fmt::format("it has a table {}, not {}", own[k].name, other[k].name);
    }
    const std::string channels = difference(own[k].channels, other[k].channels);
    if (channels.empty()) continue;
    return fmt::format("its table {} has other channels: {}", own[k].name, channels);
  }
  return "";
}

void check_joined(const Reader& reader, const Reader& first) {
  const Head &own = reader.head(), &other = first.head();
  if (const std::string channels = difference(own.channels, other.channels); !channels.empty()) {
    refuse_to_join(
        reader, first,
        fmt::format("it has other channels: {}; 'psf cat --channels' and '--quantize' make "
                    "them the same",
                    channels));
  }
  if (const std::string tables = difference(own.tables, other.tables); !tables.empty()) {
    refuse_to_join(reader, first, fmt::format("{}; 'psf cat --drop' leaves tables out", tables));
  }
  if (own.minor != other.minor || own.optional_features != other.optional_features ||
      own.later_fields != other.later_fields || own.later_bytes != other.later_bytes) {
    refuse_to_join(reader, first, "it is of another version of the format");
  }
  const Json now = metadata_of(reader), before = metadata_of(first);
  const auto compare = [&](const std::string& key) {
    if (has(kFree, key)) return;
    const Json a = now.value(key, Json()), b = before.value(key, Json());
    if (a == b) return;
    if (key == kMaterials && (a.is_null() || b.is_null())) return;  // names that one does not tell
    const bool brief = a.dump().size() + b.dump().size() < 120;
    refuse_to_join(reader, first,
                   fmt::format("its {} is another{}", key,
                               brief ? fmt::format(": {}, not {}", a.dump(), b.dump()) : ""));
  };
  for (const auto& item : now.items()) compare(item.key());
  for (const auto& item : before.items()) compare(item.key());
}

// A file of several frames tells by its passes which are of which.
void check_frames(std::span<const JoinedInput> inputs) {
  for (const JoinedInput& input : inputs) {
    const auto frames = parse_metadata(input.reader.head().metadata).frames;
    if (!frames || frames->count == 1 || (inputs.size() == 1 && input.first == 0)) continue;
    throw Error(
        ErrorCode::usage,
        fmt::format("{}: has the frames {}:{}: they cannot be joined with others, nor cut at "
                    "the begin; render a file a frame, by #### in its name",
                    input.reader.path(), frames->first,
                    frames->first + std::uint64_t{frames->count}));
  }
}

std::string joined_metadata(std::span<const JoinedInput> inputs) {
  check_frames(inputs);
  Json metadata = metadata_of(inputs.front().reader);
  if (inputs.size() == 1) return inputs.front().reader.head().metadata;
  Json joined = Json::array();
  for (const JoinedInput& input : inputs) {
    const Json own = metadata_of(input.reader);
    Json entry{{"uuid", input.reader.uuid()}, {"passes", input.last - input.first}};
    for (const char* key : {"producer", "sampler", "seed", "split", "joined"}) {
      if (own.contains(key)) entry[key] = own.at(key);
    }
    joined.push_back(std::move(entry));
    if (own.contains(kMaterials)) metadata[kMaterials] = own.at(kMaterials);
  }
  metadata["joined"] = std::move(joined);
  return metadata.dump();
}

std::vector<std::string> notes_on(std::span<const JoinedInput> inputs) {
  std::vector<std::string> notes;
  std::set<std::string> uuids, seeds;
  for (const JoinedInput& input : inputs) {
    const Json metadata = metadata_of(input.reader);
    const Reader& reader = input.reader;
    if (!uuids.insert(reader.uuid()).second) {
      notes.push_back(reader.path() + ": its uuid comes twice: the same paths count twice");
    } else if (metadata.contains("seed") &&
               !seeds.insert(metadata.value("sampler", "") + metadata["seed"].dump()).second) {
      notes.push_back(
          fmt::format("{}: seed {} comes twice: unless these are other passes of one "
                      "render, the same paths count twice",
                      reader.path(), metadata["seed"].dump()));
    }
  }
  return notes;
}

Channel quantized(const Channel& channel, const std::string& path) {
  if (channel.encoding == Encoding::octahedral || channel.type == Type::f16) return channel;
  if (channel.type == Type::f32) {
    const bool unit = channel.name == "normal" || channel.name == "direction";
    if (unit && channel.components == 3) {
      return {channel.name, Type::u16, 2, Encoding::octahedral};
    }
    return {channel.name, Type::f16, channel.components, Encoding::plain};
  }
  throw Error(ErrorCode::usage, fmt::format("{}: channel {} is {}; only f32 can be quantised", path,
                                            channel.name, name_of(channel.type)));
}

// Throws where `names` has one that is no channel, and no table where these are meant, too.
void check_names(const Reader& reader, std::span<const std::string> names, bool tables = false) {
  for (const std::string& name : names) {
    if (reader.head().find(name) || (tables && reader.head().find_table(name).value_or(0) > 0)) {
      continue;
    }
    std::vector<std::string> known;
    for (const Channel& channel : reader.head().channels) known.push_back(channel.name);
    const bool with_tables = tables && !reader.head().tables.empty();
    std::string more;
    for (const Table& table : reader.head().tables) more += ", " + table.name;
    throw Error(
        ErrorCode::bad_input,
        fmt::format("{}: has no channel {}{}; it has {}{}{}", reader.path(),
                    with_tables ? "or table " : "", name, fmt::join(known, ", "),
                    with_tables ? ", and the tables " : "", with_tables ? more.substr(2) : ""));
  }
}

bool is_kept(const std::string& name, const ConcatenateOptions& options) {
  return is_required_channel(name) ||
         ((options.channels.empty() || has(options.channels, name)) && !has(options.drop, name));
}

// The channels of the paths that are written.
JoinedTable joined_paths(const Reader& first, const ConcatenateOptions& options) {
  JoinedTable paths;
  const std::vector<Channel>& channels = first.head().channels;
  for (std::size_t k = 0; k < channels.size(); ++k) {
    if (!is_kept(channels[k].name, options)) continue;
    const Channel written = has(options.quantize, channels[k].name)
                                ? quantized(channels[k], first.path())
                                : channels[k];
    paths.channels.push_back({k, written, written != channels[k]});
  }
  return paths;
}

void add_tables(const ConcatenateOptions& options, JoinedHead& joined) {
  const std::vector<Table> all = std::exchange(joined.head.tables, {});
  for (std::size_t k = 1; k <= all.size(); ++k) {
    const Table& table = all[k - 1];
    if (has(options.drop, table.name)) continue;
    JoinedTable copied{k, {}};
    for (std::size_t c = 0; c < table.channels.size(); ++c) {
      copied.channels.push_back({c, table.channels[c], false});
    }
    joined.tables.push_back(std::move(copied));
    joined.head.tables.push_back(table);
  }
  // Without them it is a file of version 1.0, unless a later one wrote it.
  const bool dropped = joined.head.tables.size() < all.size();
  if (dropped && joined.head.tables.empty() && joined.head.minor == kMinor) joined.head.minor = 0;
}

}  // namespace

JoinedHead join_heads(std::span<const JoinedInput> inputs, const ConcatenateOptions& options) {
  const Reader& first = inputs.front().reader;
  JoinedHead joined;
  joined.head = first.head();
  for (const JoinedInput& input : inputs.subspan(1)) {
    check_joined(input.reader, first);
    const Head& other = input.reader.head();
    joined.head.chunk_capacity = std::max(joined.head.chunk_capacity, other.chunk_capacity);
    for (std::size_t k = 0; k < joined.head.tables.size(); ++k) {
      std::uint32_t& capacity = joined.head.tables[k].chunk_capacity;
      capacity = std::max(capacity, other.tables[k].chunk_capacity);
    }
  }
  check_names(first, options.channels);
  check_names(first, options.drop, true);
  check_names(first, options.quantize);
  for (const std::string& name : options.drop) {
    if (!is_required_channel(name)) continue;
    throw Error(ErrorCode::usage,
                fmt::format("channel {} cannot be dropped: no dump is one without it", name));
  }
  joined.tables.push_back(joined_paths(first, options));
  joined.head.channels.clear();
  for (const JoinedChannel& channel : joined.tables[0].channels) {
    joined.head.channels.push_back(channel.channel);
  }
  add_tables(options, joined);
  joined.head.metadata = joined_metadata(inputs);
  joined.notes = notes_on(inputs);
  return joined;
}

}  // namespace psf::formats
