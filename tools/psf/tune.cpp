// psf tune: the best parameters for a dump, without a reference.
#include "study/tune.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "cli.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/text.h"
#include "filter/parameters/text.h"
#include "filter_options.h"
#include "noise_report.h"
#include "notes.h"
#include "parameter_lists.h"
#include "pass_range.h"
#include "study/tune_file.h"
#include "study_folder.h"
#include "verbs.h"
#include "version.h"
#include "vertex_option.h"

namespace psf::tools {
namespace {

struct TuneOptions {
  CommonOptions common;
  ParameterLists lists;
  std::string input, vertex, passes, camera;
  double epsilon = study::TuneRequest().epsilon;
  std::optional<std::uint64_t> max_memory;
};

constexpr std::size_t kRowsShown = 8;  // rows of the table
constexpr double kCorrelated = 0.05;   // correlation of the parts' noise that is worth a note

// As psf filter takes them, what is the default left out.
std::string as_options(const filter::Parameters& parameters) {
  const auto defaults = filter::describe(filter::Parameters());
  const auto own = filter::describe(parameters);
  std::string text;
  for (std::size_t k = 0; k < own.size(); ++k) {
    if (own[k].second == defaults[k].second && own[k].first != "r0") continue;
    text += fmt::format(" --{}={}", own[k].first, own[k].second);
  }
  return text.substr(1);
}

void print(const study::TuneResult& tuning, const run::Dump& dump) {
  const std::vector<const study::TuneRow*> rows = study::by_error(tuning);
  fmt::print("{:>10} {:>9} {:>10} {:>10} {:>10} {:>10}  parameters\n", "error", "+-", "bias^2",
             "variance", "neighbours", "sigmas off");
  for (std::size_t k = 0; k < std::min(kRowsShown, rows.size()); ++k) {
    const study::TuneRow& row = *rows[k];
    fmt::print("{:>10.4g} {:>9.2g} {:>10.4g} {:>10.4g} {:>10.1f} {:>10.1f}  {}\n", row.error,
               row.standard_error, row.bias_sq, row.variance, row.neighbors, row.sigmas_above_least,
               as_options(row.parameters));
  }
  const study::TuneRow& best = tuning.rows[tuning.best];
  fmt::print("{:>10.4g}  unfiltered\nchosen: {}\n", tuning.unfiltered, as_options(best.parameters));
  constexpr double kPercent = 100;
  const std::size_t doubtful = study::may_be_better(tuning);
  if (doubtful == 0) {
    fmt::print("sure: its error is at most {:.0f}% above any other's, by {} standard errors\n",
               kPercent * study::kTolerance, study::kSure);
  } else {
    fmt::print("not sure: its error may be more than {:.0f}% above that of {} of the {} sets\n",
               kPercent * study::kTolerance, doubtful, tuning.rows.size());
  }
  fmt::print(
      "u's share of the noise, which no parameter reaches: {}; each error has {:.3g} of u and "
      "{:.3g} of what u and the rest have in common\n",
      share_text(tuning.noise), tuning.u_variance, tuning.u_covariance);
  if (!tuning.has_independent_paths) {
    const std::string& sampler = dump.metadata().sampler;
    fmt::print(
        "{}: the noise of its parts correlates by {:.3f}, so errors are known up to a "
        "constant, taken to be {:.3g}\n",
        sampler.empty() ? "the dump names no sampler, so its passes may not be independent"
                        : fmt::format("the passes of a {} sequence are not independent", sampler),
        tuning.correlation, tuning.constant);
  } else if (std::abs(tuning.correlation) >= kCorrelated) {
    fmt::print(
        "the noise of its parts correlates by {:.3f}: what is common to them is taken for "
        "truth\n",
        tuning.correlation);
  }
}

void run(const TuneOptions& options) {
  keep_freed_memory();
  const core::ThreadLimit threads(options.common.threads);
  ParameterLists lists = options.lists;
  lists.given.try_emplace("r0", study::kTuneRadii);
  std::vector<filter::Parameters> sets = all_sets(lists);
  const run::Dump dump = open_dump(options.input, options.vertex);
  std::vector<std::string> notes;
  fit_terms(dump, sets, filter::asked_terms(options.lists.given), notes);
  study::TuneRequest tune;
  tune.sets = sets;
  tune.passes = parse_passes(options.passes);
  static_cast<void>(run::last_pass(dump, tune.passes));
  tune.camera = find_camera(dump, options.camera);
  tune.epsilon = options.epsilon;
  tune.max_memory = options.max_memory;
  check_files({options.input}, {options.common.json});
  if (std::any_of(sets.begin(), sets.end(), [](const filter::Parameters& set) {
        return set.pixels != filter::PixelRule::keep;
      })) {
    notes.emplace_back(
        "`pixels`: sets are compared before the second pass, so those that differ in it alone are "
        "equal");
  }
  print_notes(notes, options.common.quiet);
  core::Progress progress("tune", options.common.quiet);
  tune.on_progress = [&progress](std::uint64_t done, std::uint64_t total) {
    progress.advance(done, total);
  };
  const study::TuneResult tuning = study::tune(dump, tune);
  progress.finish();
  if (!options.common.json.empty()) {
    core::write_json_file(options.common.json, study::to_json(tuning, dump, tune, kVersion), 1);
  }
  print(tuning, dump);
  if (options.common.json.empty()) return;
  fmt::print("psf filter --tuned {} takes the choice\n", options.common.json);
}

}  // namespace

void add_tune(CLI::App& app) {
  auto options = std::make_shared<TuneOptions>();
  CLI::App* command =
      app.add_subcommand("tune", "find the best parameters for a dump, without a reference");
  command->add_option("IN", options->input, "path-vertex buffer")
      ->required()
      ->type_name("FILE.pvb");
  add_vertex(*command, options->vertex);
  command->add_option("--passes", options->passes, kPassesHelp)->type_name("FIRST:LAST");
  command->add_option("--camera", options->camera, "which camera, where the dump has several")
      ->type_name("NAME");
  command->add_option("--epsilon", options->epsilon, "of the relative error: guards dark places")
      ->capture_default_str();
  command
      ->add_option("--max-memory", options->max_memory,
                   "what it may take, 500M or 4G: shares less, or refuses (default no limit)")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("SIZE");
  add_parameter_lists(*command, options->lists);
  command->get_option("--r0")->description("radii (default nine from 2px to 32px)");
  add_common(*command, options->common);
  set_example(*command, "psf tune scene.pvb --delta 0.2,0.33,0.5 --json tuned.json");
  command->callback([options] { run(*options); });
}

}  // namespace psf::tools
