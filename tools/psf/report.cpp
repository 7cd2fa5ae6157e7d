// psf report: a page to look at, from the folders of sweeps and convergence studies.
#include "study/report/report.h"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli.h"
#include "core/output_file.h"
#include "text.h"
#include "verbs.h"
#include "version.h"

namespace psf::tools {
namespace {

struct ReportCommand {
  std::vector<std::string> folders;
  std::string output;
  study::ReportOptions report;
  CommonOptions common;
};

void run(const ReportCommand& command) {
  const study::ReportOutcome outcome =
      study::write_report(command.folders, command.output, command.report);
  fmt::print(
      "{}: {}, {}, {:.1f} MB\n", command.output, counted(outcome.sections, "study", "studies"),
      counted(outcome.pictures, "picture", "pictures"), static_cast<double>(outcome.bytes) / 1e6);
  if (outcome.pictures_left_out > 0 && !command.common.quiet) {
    fmt::print(stderr, "psf report: note: {} left out, the worst ones; see --max-pictures\n",
               counted(outcome.pictures_left_out, "picture was", "pictures were"));
  }
  if (!command.common.json.empty()) {
    const nlohmann::ordered_json figures = {{"report", command.output},
                                            {"studies", outcome.sections},
                                            {"pictures", outcome.pictures},
                                            {"pictures_left_out", outcome.pictures_left_out},
                                            {"bytes", outcome.bytes}};
    core::write_text_file(command.common.json, figures.dump(2) + "\n");
  }
}

}  // namespace

void add_report(CLI::App& app) {
  auto options = std::make_shared<ReportCommand>();
  options->report.version = kVersion;
  CLI::App* command = app.add_subcommand(
      "report", "make one HTML page of sweeps and convergence studies: maps, plots, pictures");
  command
      ->add_option("DIR", options->folders,
                   "folders that psf sweep or psf converge wrote, or a folder of such")
      ->required();
  command->add_option("-o,--output", options->output, "the page")
      ->required()
      ->type_name("REPORT.html");
  command
      ->add_option("--max-pictures", options->report.max_pictures,
                   "pictures to embed of each study; reference, unfiltered and the best come first")
      ->capture_default_str();
  add_common(*command, options->common);
  set_example(*command, "psf report sweep-folder converge-folder -o report.html");
  command->callback([options] { run(*options); });
}

}  // namespace psf::tools
