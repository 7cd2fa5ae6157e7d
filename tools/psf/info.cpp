// psf info: what a path-vertex buffer holds, what it costs, and statistics of its channels on
// request.
#include <fmt/format.h>

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
#include "info_report.h"
#include "info_tables.h"
#include "run/dump.h"
#include "study/study_file.h"
#include "verbs.h"

namespace psf::tools {
namespace {

struct InfoOptions {
  CommonOptions common;
  std::string input;
  bool statistics = false;
};

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
    nlohmann::ordered_json json = describe_file(reader, tables);
    if (!noise.of.empty()) json["noise"] = study::describe_noise(noise.of, metadata.cameras);
    core::write_json_file(options.common.json, json);
  }
  print_overview(reader, metadata);
  print_tables(metadata);
  for (const TableInfo& info : tables) print_channels(info);
  if (options.statistics) {
    for (const TableInfo& info : tables) print_statistics(info);
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
