// psf report: a page to look at, from the folders of studies.
#include "report/report.h"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "core/standard_streams.h"
#include "core/text.h"
#include "option_values.h"
#include "verbs.h"
#include "version.h"

namespace psf::tools {
namespace fs = std::filesystem;
namespace {

struct ReportCommand {
  std::vector<std::string> folders;
  std::string output;
  report::ReportOptions report;
  CommonOptions common;
};

// What a study is made of: the report must not take its place.
void add_files(const fs::path& folder, std::vector<std::string>& files) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path& path = entry.path();
    const fs::path name = path.stem();
    const bool is_study = name == "sweep" || name == "converge" || name == "ablate";
    if (is_study || path.extension() == ".exr") files.push_back(path.string());
  }
}

std::vector<std::string> files_of(const std::vector<std::string>& folders) {
  std::vector<std::string> files;
  for (const std::string& folder : folders) {
    if (!fs::is_directory(folder)) continue;  // write_report() says so
    add_files(folder, files);
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      if (entry.is_directory()) add_files(entry.path(), files);
    }
  }
  return files;
}

void run(const ReportCommand& command) {
  check_files(files_of(command.folders), {command.output, command.common.json});
  const report::ReportOutcome outcome =
      report::write_report(command.folders, command.output, command.report);
  fmt::print("{}: {}, {}, {:.1f} MB\n", command.output,
             core::counted(outcome.sections, "study", "studies"),
             core::counted(outcome.pictures, "picture", "pictures"),
             static_cast<double>(outcome.bytes) / 1e6);
  if (outcome.pictures_left_out > 0 && !command.common.quiet) {
    core::say(
        fmt::format("note: {} left out, the worst ones; see --max-pictures",
                    core::counted(outcome.pictures_left_out, "picture was", "pictures were")));
  }
  if (!command.common.json.empty()) {
    const nlohmann::ordered_json figures = {{"report", command.output},
                                            {"studies", outcome.sections},
                                            {"pictures", outcome.pictures},
                                            {"pictures_left_out", outcome.pictures_left_out},
                                            {"bytes", outcome.bytes}};
    core::write_json_file(command.common.json, figures);
  }
}

}  // namespace

void add_report(CLI::App& app) {
  auto options = std::make_shared<ReportCommand>();
  options->report.version = kVersion;
  CLI::App* command = app.add_subcommand(
      "report", "make one HTML page of sweeps, convergence studies and ablations");
  command
      ->add_option("DIR", options->folders,
                   "folders that psf sweep, converge or ablate wrote, or a folder of such")
      ->required()
      ->type_name("DIR");
  command->add_option("-o,--output", options->output, "the page")
      ->required()
      ->type_name("REPORT.html");
  add_number(*command, "--max-pictures", options->report.max_pictures, std::size_t{0},
             "pictures to embed of each study; reference, unfiltered and the best come first");
  add_common(*command, options->common);
  set_example(*command, "psf report sweep-folder converge-folder -o report.html");
  command->callback([options] { run(*options); });
}

}  // namespace psf::tools
