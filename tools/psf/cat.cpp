// psf cat: joins path-vertex buffers and changes how they are stored.
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli.h"
#include "core/interrupt.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/standard_streams.h"
#include "core/text.h"
#include "formats/write/concatenate.h"
#include "pass_range.h"
#include "verbs.h"

namespace psf::tools {
namespace {

struct CatOptions {
  CommonOptions common;
  std::vector<std::string> inputs, channels, drop, quantize;
  std::string output, codec, passes;
};

formats::ConcatenateOptions to_library(const CatOptions& options) {
  formats::ConcatenateOptions result;
  if (options.codec == "raw") result.codec = formats::Codec::raw;
  if (options.codec == "zstd") result.codec = formats::Codec::zstd;
  result.channels = options.channels;
  result.drop = options.drop;
  result.quantize = options.quantize;
  const run::PassSelection range = parse_passes(options.passes);
  result.first_pass = range.first;
  result.last_pass = range.last;
  return result;
}

void run(const CatOptions& options) {
  const core::ThreadLimit threads(options.common.threads);
  // It may replace one of its inputs: until it is whole it has another name.
  check_files({}, {options.output, options.common.json});
  check_files(options.inputs, {options.common.json});
  core::Progress progress("cat", options.common.quiet);
  const formats::ConcatenateResult report =
      formats::concatenate(options.inputs, core::followed(options.output), to_library(options),
                           [&](std::uint64_t done, std::uint64_t total) {
                             core::throw_if_interrupted("nothing is written");
                             progress.advance(done, total);
                           });
  progress.finish();
  if (!options.common.quiet) {
    for (const std::string& note : report.notes) core::say("note: " + note);
    if (report.overflows > 0) {
      core::say(fmt::format("note: {} too large for f16 and became infinite",
                            core::counted(report.overflows, "value was", "values were")));
    }
  }
  fmt::print("{}: {} in {}, {} bytes\n", options.output,
             core::counted(report.records, "record", "records"),
             core::counted(report.passes, "pass", "passes"), core::with_commas(report.bytes));
  if (!options.common.json.empty()) {
    const nlohmann::ordered_json figures = {
        {"inputs", options.inputs}, {"output", options.output}, {"records", report.records},
        {"passes", report.passes},  {"bytes", report.bytes},    {"overflows", report.overflows},
        {"notes", report.notes}};
    core::write_json_file(options.common.json, figures);
  }
}

}  // namespace

void add_cat(CLI::App& app) {
  auto options = std::make_shared<CatOptions>();
  CLI::App* command = app.add_subcommand(
      "cat", "join dumps of the same scene, one behind the other, and change how they are stored");
  command->add_option("IN", options->inputs, "path-vertex buffers, in the order of their passes")
      ->required()
      ->type_name("FILE.pvb");
  command->add_option("-o,--output", options->output, "path-vertex buffer to write")
      ->required()
      ->type_name("OUT.pvb");
  command->add_option("--codec", options->codec, "store all columns so; as they are unless given")
      ->check(CLI::IsMember({"raw", "zstd"}));
  const auto names = [&](const char* option, std::vector<std::string>& list, const char* help) {
    return command->add_option(option, list, help)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("NAME,...");
  };
  names("--channels", options->channels, "keep only these and those that every dump has");
  names("--drop", options->drop, "leave these channels, or tables, out");
  names("--quantize", options->quantize,
        "normal, direction: octahedral 2 x 16 bits; others: half floats");
  command->add_option("--passes", options->passes, kPassesHelp)->type_name("FIRST:LAST");
  add_common(*command, options->common);
  set_example(*command, "psf cat monday.pvb tuesday.pvb -o both.pvb --quantize normal,reflectance");
  command->callback([options] { run(*options); });
}

}  // namespace psf::tools
