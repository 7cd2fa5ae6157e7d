// psf info: what a path-vertex buffer holds, what it costs, and statistics of its channels on
// request.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "formats/layout/metadata.h"
#include "formats/read/reader.h"
#include "formats/read/statistics.h"
#include "info_tables.h"
#include "noise_report.h"
#include "study/study_file.h"
#include "verbs.h"

namespace psf::tools {
namespace {

struct InfoOptions {
  CommonOptions common;
  std::string input;
  bool statistics = false;
};

using Statistics = std::vector<std::vector<formats::ComponentStatistics>>;  // by channel

// 1234567 -> "1,234,567"
std::string grouped(std::uint64_t value) {
  std::string text = std::to_string(value);
  for (auto k = static_cast<std::ptrdiff_t>(text.size()) - 3; k > 0; k -= 3) {
    text.insert(static_cast<std::size_t>(k), ",");
  }
  return text;
}

std::string bytes(std::uint64_t count) {
  if (count < 1000) return fmt::format("{} B", count);
  double value = static_cast<double>(count);
  const char* unit = "";
  for (const char* next : {"kB", "MB", "GB", "TB"}) {
    if (value < 999.5) break;
    value /= 1000;
    unit = next;
  }
  return fmt::format("{:.{}f} {}", value, value < 99.95 ? 1 : 0, unit);
}

double ratio(const formats::ChannelSize& size) {
  return size.raw == 0 ? 1 : static_cast<double>(size.stored) / static_cast<double>(size.raw);
}

std::string type_text(const formats::Channel& channel) {
  std::string text(name_of(channel.type));
  if (channel.components > 1) text += fmt::format(" x {}", channel.components);
  if (channel.encoding == formats::Encoding::octahedral) text += " oct";
  return text;
}

std::string codec_text(const formats::ChannelSize& size) {
  if (size.zstd_columns == 0) return "raw";
  return size.raw_columns == 0
             ? "zstd"
             : fmt::format("zstd, raw in {} of {} chunks", grouped(size.raw_columns),
                           grouped(size.raw_columns + size.zstd_columns));
}

std::string passes_text(const formats::Reader& reader) {
  const auto passes = reader.passes();
  const bool even = std::all_of(passes.begin(), passes.end(),
                                [&](const auto& pass) { return pass.count == passes[0].count; });
  if (passes.size() == 1) return "1 pass";
  return fmt::format("{} passes{}", grouped(passes.size()),
                     even && !passes.empty() ? " of " + grouped(passes[0].count) : "");
}

void line(const char* name, const std::string& value) {
  fmt::print("  {:<12}{}\n", name, value);
}

void print_overview(const formats::Reader& reader, const formats::Metadata& metadata) {
  const formats::Head& head = reader.head();
  fmt::print("{}: path-vertex buffer {}.{}, {}\n", reader.path(), head.major, head.minor,
             reader.closed() ? "closed" : "not closed (being written, or its writer was stopped)");
  line("producer", shown_or_dash(metadata.producer));
  line("scene",
       shown_or_dash(metadata.scene) +
           (metadata.scene_hash.empty() ? "" : ", hash " + shown_or_dash(metadata.scene_hash)));
  line("paths", fmt::format("{}, {} sampler by {}, seed {}, block base {}, split {}",
                            shown_or_dash(metadata.integrator), shown_or_dash(metadata.sampler),
                            shown_or_dash(metadata.enumeration), metadata.seed, metadata.block_base,
                            metadata.split));
  line("vertex", shown_or_dash(metadata.vertex_rule));
  line("units", shown_or_dash(metadata.units));
  line("uuid", reader.uuid());
  line("records",
       fmt::format("{} in {}, {} chunk{}", grouped(reader.records()), passes_text(reader),
                   grouped(reader.chunks().size()), reader.chunks().size() == 1 ? "" : "s"));
  if (metadata.frames) {
    const formats::FrameInfo& frames = *metadata.frames;
    line("frames", fmt::format("{}:{}, {} {} each{}", frames.first,
                               frames.first + std::uint64_t{frames.count}, frames.passes,
                               frames.passes == 1 ? "pass" : "passes",
                               frames.cameras.empty() ? "" : ", cameras that move"));
  }
  line("file", bytes(reader.file_bytes()) + (reader.uncommitted_bytes() == 0
                                                 ? ""
                                                 : fmt::format(", of which {} are not committed",
                                                               bytes(reader.uncommitted_bytes()))));
}

// The width of the column with the channels' names.
std::size_t name_width(const formats::Schema& schema) {
  std::size_t width = 14;
  for (const formats::Channel& channel : schema.channels) {
    width = std::max(width, channel.name.size());
  }
  return width;
}

// A blank line, and before what is of a table its name.
void print_title(const formats::TableReader& table) {
  fmt::print("\n");
  if (table.name() == formats::kPaths) return;
  line("table", fmt::format("{}: {} records, {} chunk{}", table.name(), grouped(table.records()),
                            grouped(table.chunks().size()), table.chunks().size() == 1 ? "" : "s"));
}

void print_channels(const formats::TableReader& table,
                    const std::vector<formats::ChannelSize>& sizes) {
  constexpr const char* kRow = "  {:<{}} {:<11}{:>9}{:>10}{:>7}  {}\n";
  const std::size_t width = name_width(table.schema());
  print_title(table);
  fmt::print(kRow, "channel", width, "type", "raw", "stored", "ratio", "codec");
  formats::ChannelSize total;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    const formats::Channel& channel = table.schema().channels[k];
    fmt::print(kRow, channel.name, width, type_text(channel), bytes(sizes[k].raw),
               bytes(sizes[k].stored), fmt::format("{:.2f}", ratio(sizes[k])),
               codec_text(sizes[k]));
    total.raw += sizes[k].raw;
    total.stored += sizes[k].stored;
  }
  fmt::print(kRow, "all", width, fmt::format("{} B/record", table.schema().stride()),
             bytes(total.raw), bytes(total.stored), fmt::format("{:.2f}", ratio(total)), "");
}

Statistics read_statistics(const formats::TableReader& table, bool quiet) {
  const std::size_t channels = table.schema().channels.size(), chunks = table.chunks().size();
  Statistics statistics;
  core::Progress progress("statistics", quiet);
  for (std::size_t k = 0; k < channels; ++k) {
    statistics.push_back(formats::channel_statistics(table, k, [&](std::size_t done) {
      core::throw_if_interrupted("not all was read");
      progress.advance(k * chunks + done, channels * chunks);
    }));
  }
  progress.finish();
  return statistics;
}

void print_statistics(const formats::TableReader& table, const Statistics& statistics) {
  constexpr const char* kRow = "  {:<{}} {:>3}{:>14}{:>14}{:>14}{:>12}\n";
  const std::size_t width = name_width(table.schema());
  print_title(table);
  fmt::print(kRow, "channel", width, "", "min", "max", "mean", "non-finite");
  for (std::size_t k = 0; k < statistics.size(); ++k) {
    for (std::size_t c = 0; c < statistics[k].size(); ++c) {
      const formats::ComponentStatistics& of = statistics[k][c];
      const auto number = [&](double value) {
        return of.finite == 0 ? std::string("-") : fmt::format("{:.6g}", value);
      };
      fmt::print(kRow, c == 0 ? table.schema().channels[k].name : "", width,
                 statistics[k].size() > 1 ? std::to_string(c) : "", number(of.min), number(of.max),
                 number(of.mean()), grouped(of.non_finite));
    }
  }
}

// The noise shares of each camera, where the file is a dump that can be filtered.
struct Noise {
  std::vector<run::NoiseShare> of;
  std::string unknown;  // the reason why there are no shares
};

Noise read_noise(const std::string& path) {
  try {
    const run::Dump dump(path);
    return {run::noise_shares(dump, {}), ""};
  } catch (const Error& error) {
    // Usage: of several frames.
    if (error.code() != ErrorCode::bad_input && error.code() != ErrorCode::usage) throw;
    return {{}, error.what()};
  }
}

void print_noise(const formats::Metadata& metadata, const Noise& noise) {
  fmt::print("\n");
  if (noise.of.empty()) return line("noise", "not known: " + shown_or_dash(noise.unknown));
  fmt::print("  {:<14}{}\n", "camera", "u's share of the noise, which no filter of c reaches");
  for (std::size_t k = 0; k < noise.of.size(); ++k) {
    fmt::print("  {:<14}{}\n", shown_or_dash(metadata.cameras[k].name), share_text(noise.of[k]));
  }
}

// What is told of the paths, or of a table.
struct TableInfo {
  const formats::TableReader& table;
  std::vector<formats::ChannelSize> sizes;
  Statistics statistics;  // empty unless asked for
};

nlohmann::ordered_json channels_json(const TableInfo& info) {
  using Json = nlohmann::ordered_json;
  const auto& [table, sizes, statistics] = info;
  Json channels = Json::array();
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    const formats::Channel& channel = table.schema().channels[k];
    Json entry = {
        {"name", channel.name},
        {"type", name_of(channel.type)},
        {"components", channel.components},
        {"encoding", channel.encoding == formats::Encoding::plain ? "plain" : "octahedral"},
        {"raw_bytes", sizes[k].raw},
        {"stored_bytes", sizes[k].stored},
        {"ratio", ratio(sizes[k])}};
    if (!statistics.empty()) {
      Json components = Json::array();
      for (const formats::ComponentStatistics& of : statistics[k]) {
        components.push_back({{"min", of.min},  // null where no value is finite
                              {"max", of.max},
                              {"mean", of.mean()},
                              {"finite", of.finite},
                              {"non_finite", of.non_finite}});
      }
      entry["statistics"] = std::move(components);
    }
    channels.push_back(std::move(entry));
  }
  return channels;
}

nlohmann::ordered_json passes_json(const formats::TableReader& table) {
  nlohmann::ordered_json passes = nlohmann::ordered_json::array();
  for (const formats::Pass& pass : table.passes()) {
    passes.push_back({{"first_record", pass.first}, {"records", pass.count}});
  }
  return passes;
}

nlohmann::ordered_json to_json(const formats::Reader& reader, const std::vector<TableInfo>& infos) {
  using Json = nlohmann::ordered_json;
  Json tables = Json::array();
  for (std::size_t k = 1; k < infos.size(); ++k) {
    const formats::TableReader& table = infos[k].table;
    tables.push_back({{"name", table.name()},
                      {"records", table.records()},
                      {"chunks", table.chunks().size()},
                      {"passes", passes_json(table)},
                      {"channels", channels_json(infos[k])}});
  }
  return {{"file", reader.path()},
          {"version", {reader.head().major, reader.head().minor}},
          {"uuid", reader.uuid()},
          {"closed", reader.closed()},
          {"records", reader.records()},
          {"chunks", reader.chunks().size()},
          {"file_bytes", reader.file_bytes()},
          {"uncommitted_bytes", reader.uncommitted_bytes()},
          {"passes", passes_json(infos[0].table)},
          {"channels", channels_json(infos[0])},
          {"tables", std::move(tables)},
          {"metadata", Json(nlohmann::json::parse(reader.head().metadata))}};
}

formats::Metadata metadata_of(const formats::Reader& reader) {
  try {
    return formats::parse_metadata(reader.head().metadata);
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("{}: {}", reader.path(), error.what()));
  }
}

void run(const InfoOptions& options) {
  const core::ThreadLimit threads(options.common.threads);
  check_files({options.input}, {options.common.json});
  const formats::Reader reader(options.input);
  const formats::Metadata metadata = metadata_of(reader);
  std::vector<TableInfo> tables;
  for (std::size_t k = 0; k < reader.head().table_count(); ++k) {
    const formats::TableReader& table = reader.table(k);
    tables.push_back({table, channel_sizes(table), {}});
    if (options.statistics) {
      tables.back().statistics = read_statistics(table, options.common.quiet);
    }
  }
  Noise noise;
  if (options.statistics) noise = read_noise(options.input);
  if (!options.common.json.empty()) {
    nlohmann::ordered_json json = to_json(reader, tables);
    if (!noise.of.empty()) json["noise"] = study::describe_noise(noise.of, metadata.cameras);
    core::write_json_file(options.common.json, json);
  }
  print_overview(reader, metadata);
  print_tables(metadata);
  for (const TableInfo& info : tables) print_channels(info.table, info.sizes);
  if (options.statistics) {
    for (const TableInfo& info : tables) print_statistics(info.table, info.statistics);
    print_noise(metadata, noise);
  }
}

}  // namespace

void add_info(CLI::App& app) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command = app.add_subcommand(
      "info", "show what a path-vertex buffer holds: channels, cameras, passes, sizes, metadata");
  command->add_option("IN", options->input, "path-vertex buffer")
      ->required()
      ->type_name("FILE.pvb");
  command->add_flag("--stats", options->statistics,
                    "also smallest, largest and mean value of each channel, how many are not "
                    "finite, and u's share of the noise; reads the whole file");
  add_common(*command, options->common);
  set_example(*command, "psf info scene.pvb --stats");
  command->callback([options] { run(*options); });
}

}  // namespace psf::tools
