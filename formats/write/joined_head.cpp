#include "formats/write/joined_head.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

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

std::string table_names(const Head& head) {
  std::vector<std::string> texts;
  for (const Table& table : head.tables) texts.push_back(to_text(table));
  return texts.empty() ? "none" : fmt::format("{}", fmt::join(texts, ", "));
}

void check_joined(const Reader& reader, const Reader& first) {
  const Head &own = reader.head(), &other = first.head();
  if (own.channels != other.channels) {
    std::size_t k = 0;
    while (k < own.channels.size() && k < other.channels.size() &&
           own.channels[k] == other.channels[k]) {
      ++k;
    }
    refuse_to_join(
        reader, first,
        fmt::format("it has other channels: as number {} {}, not {}; 'psf cat --channels' and "
                    "'--quantize' make them the same",
                    k, k < own.channels.size() ? to_text(own.channels[k]) : "none",
                    k < other.channels.size() ? to_text(other.channels[k]) : "none"));
  }
  if (own.tables != other.tables) {
    refuse_to_join(reader, first,
                   fmt::format("it has other tables: {}, not {}; 'psf cat --drop' leaves them out",
                               table_names(own), table_names(other)));
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
    throw Error(ErrorCode::bad_input, fmt::format("{}: has no channel {}; it has {}", reader.path(),
                                                  name, fmt::join(known, ", ")));
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

void add_tables(const Reader& first, const ConcatenateOptions& options, JoinedHead& joined) {
  joined.head.tables.clear();
  for (std::size_t k = 1; k < first.head().table_count(); ++k) {
    const Table& table = first.head().tables[k - 1];
    if (has(options.drop, table.name)) continue;
    JoinedTable copied{k, {}};
    for (std::size_t c = 0; c < table.channels.size(); ++c) {
      copied.channels.push_back({c, table.channels[c], false});
    }
    joined.tables.push_back(std::move(copied));
    joined.head.tables.push_back(table);
  }
  // Without them it is a file of version 1.0, unless a later one wrote it.
  const bool dropped = joined.head.tables.size() < first.head().tables.size();
  if (dropped && joined.head.tables.empty() && joined.head.minor == kMinor) joined.head.minor = 0;
}

}  // namespace

JoinedHead join_heads(std::span<const JoinedInput> inputs, const ConcatenateOptions& options) {
  const Reader& first = inputs.front().reader;
  JoinedHead joined;
  joined.head = first.head();
  for (const JoinedInput& input : inputs.subspan(1)) {
    check_joined(input.reader, first);
    joined.head.chunk_capacity =
        std::max(joined.head.chunk_capacity, input.reader.head().chunk_capacity);
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
  add_tables(first, options, joined);
  joined.head.metadata = joined_metadata(inputs);
  joined.notes = notes_on(inputs);
  return joined;
}

}  // namespace psf::formats
