// psf verify: checks every frame, checksum, total and padding byte of a path-vertex buffer.
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
#include "formats/check/check.h"
#include "verbs.h"

namespace psf::tools {
namespace {

struct VerifyOptions {
  CommonOptions common;
  std::string input;
};

nlohmann::ordered_json to_json(const std::string& path, const formats::CheckResult& report) {
  nlohmann::ordered_json tables = nlohmann::ordered_json::object();
  for (std::size_t k = 0; k < report.table_records.size(); ++k) {
    tables[report.head.tables[k].name] = report.table_records[k];
  }
  return {{"file", path},
          {"whole", report.faults.empty()},
          {"closed", report.closed},
          {"records", report.records},
          {"table_records", std::move(tables)},
          {"passes", report.passes},
          {"file_bytes", report.file_bytes},
          {"uncommitted_bytes", report.uncommitted_bytes},
          {"frames", report.frames},
          {"chunks", report.chunks},
          {"columns", report.columns},
          {"commits", report.commits},
          {"faults", faults_to_json(report.faults)}};
}

void run(const VerifyOptions& options) {
  const core::ThreadLimit threads(options.common.threads);
  check_files({options.input}, {options.common.json});
  core::Progress progress("verify", options.common.quiet);
  const formats::CheckResult report =
      formats::check(options.input, [&](std::uint64_t done, std::uint64_t total) {
        core::throw_if_interrupted("not all was checked");
        progress.advance(done, total);
      });
  progress.finish();

  if (!options.common.json.empty()) {
    core::write_json_file(options.common.json, to_json(options.input, report));
  }
  for (const formats::Fault& fault : report.faults) fmt::print("{}\n", fault.text());
  const std::string tail = report.uncommitted_bytes == 0
                               ? ""
                               : fmt::format("; {} bytes behind the last commit are not committed",
                                             core::with_commas(report.uncommitted_bytes));
  if (!report.faults.empty()) {
    throw Error(ErrorCode::comparison,
                fmt::format("{}: {} in {}{}; 'psf recover' saves what is whole", options.input,
                            core::counted(report.faults.size(), "fault", "faults"),
                            core::counted(report.frames, "frame", "frames"), tail));
  }
  std::string records = core::counted(report.records, "record", "records");
  for (std::size_t k = 0; k < report.table_records.size(); ++k) {
    records += fmt::format(" and {} {}", core::with_commas(report.table_records[k]),
                           report.head.tables[k].name);
  }
  fmt::print("{}: whole: {} in {}, {} in {}, {}{}\n", options.input, records,
             core::counted(report.passes, "pass", "passes"),
             core::counted(report.columns, "column", "columns"),
             core::counted(report.chunks, "chunk", "chunks"),
             report.closed ? "closed" : "not closed", tail);
}

}  // namespace

void add_verify(CLI::App& app) {
  auto options = std::make_shared<VerifyOptions>();
  CLI::App* command =
      app.add_subcommand("verify", "check every frame and checksum of a path-vertex buffer");
  command->add_option("IN", options->input, "path-vertex buffer")
      ->required()
      ->type_name("FILE.pvb");
  add_common(*command, options->common);
  set_example(*command, "psf verify scene.pvb");
  command->callback([options] { run(*options); });
}

}  // namespace psf::tools
