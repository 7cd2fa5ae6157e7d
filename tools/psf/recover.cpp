// psf recover: saves what is whole in a damaged path-vertex buffer.
#include "formats/check/recover.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/text.h"
#include "fault_json.h"
#include "verbs.h"

namespace psf::tools {
namespace {

struct RecoverVerb {
  CommonOptions common;
  std::string input, output;
  formats::RecoverOptions options;
};

nlohmann::ordered_json to_json(const RecoverVerb& verb, const formats::RecoverResult& report) {
  return {{"input", verb.input},
          {"output", verb.output},
          {"nothing_lost", report.nothing_lost()},
          {"records_saved", report.records_saved},
          {"chunks_saved", report.chunks_saved},
          {"passes_saved", report.passes_saved},
          {"records_lost", report.records_lost},
          {"uncommitted_bytes", report.uncommitted_bytes},
          {"head_restored", report.head_restored},
          {"faults", faults_to_json(report.faults)},
          {"losses", faults_to_json(report.losses)}};
}

void print(const RecoverVerb& verb, const formats::RecoverResult& report) {
  for (const formats::Fault& fault : report.faults) fmt::print("found {}\n", fault.text());
  for (const formats::Fault& loss : report.losses) fmt::print("lost  {}\n", loss.text());
  fmt::print("{}: saved {} in {} to {}\n", verb.input,
             core::counted(report.records_saved, "record", "records"),
             core::counted(report.passes_saved, "pass", "passes"), verb.output);
  if (report.uncommitted_bytes > 0) {
    fmt::print("{}: {} bytes of a pass that was not finished are left out{}\n", verb.input,
               core::with_commas(report.uncommitted_bytes),
               verb.options.uncommitted ? "" : "; --uncommitted takes what is whole of them");
  }
}

void run(const RecoverVerb& verb) {
  const core::ThreadLimit threads(verb.common.threads);
  check_files({verb.input}, {verb.output, verb.common.json});
  core::Progress progress("recover", verb.common.quiet);
  const formats::RecoverResult report =
      formats::recover(verb.input, core::followed(verb.output), verb.options,
                       [&](std::uint64_t done, std::uint64_t total) {
                         core::throw_if_interrupted("nothing is written");
                         progress.advance(done, total);
                       });
  progress.finish();
  if (!verb.common.json.empty()) {
    core::write_json_file(verb.common.json, to_json(verb, report));
  }
  print(verb, report);
  if (!report.nothing_lost()) {
    throw Error(ErrorCode::comparison,
                fmt::format("{}: {} lost; {} holds the rest", verb.input,
                            report.records_lost == 0
                                ? "a pass is"
                                : core::counted(report.records_lost, "record is", "records are"),
                            verb.output));
  }
}

}  // namespace

void add_recover(CLI::App& app) {
  auto verb = std::make_shared<RecoverVerb>();
  CLI::App* command = app.add_subcommand(
      "recover",
      "save what is whole in a damaged path-vertex buffer; exit code 0: nothing is lost, 1: saved "
      "with losses, 3: nothing can be saved");
  command->add_option("IN", verb->input, "damaged path-vertex buffer")
      ->required()
      ->type_name("FILE.pvb");
  command->add_option("OUT", verb->output, "where to save, another name")
      ->required()
      ->type_name("FILE.pvb");
  command->add_flag("--uncommitted", verb->options.uncommitted,
                    "also what is whole of a pass that was not finished");
  add_common(*command, verb->common);
  set_example(*command, "psf recover damaged.pvb saved.pvb");
  command->callback([verb] { run(*verb); });
}

}  // namespace psf::tools
