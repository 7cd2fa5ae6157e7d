// psf flicker: the error of sequences of pictures, and how much it changes from frame to frame.
#include "study/flicker.h"

#include <fmt/format.h>

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "cli.h"
#include "core/error.h"
#include "core/json_text.h"
#include "core/numbered_name.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/text.h"
#include "option_values.h"
#include "pass_range.h"
#include "trim.h"
#include "verbs.h"

namespace psf::tools {
namespace {

struct FlickerOptions {
  CommonOptions common;
  std::vector<std::string> sequences;  // names with the mark
  std::string reference, frames;       // FIRST:LAST as written; empty: 0 on, as far as there are
  std::vector<std::string> labels;
  double epsilon = study::FlickerRequest().epsilon;
  std::string trim;  // as written; empty: nothing
  std::vector<std::string> sheets;
  float exposure = 0;
  std::size_t columns = study::FlickerRequest().columns;
};

study::FrameSpan frames_of(const FlickerOptions& options) {
  const NumberRange range = parse_range(options.frames, "--frames");
  const auto number = [](std::uint64_t frame) {
    constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
    if (frame <= kMost) return static_cast<std::uint32_t>(frame);
    throw Error(ErrorCode::usage, fmt::format("--frames: {} are the most", kMost));
  };
  const std::uint32_t first = number(range.first);
  if (!range.last) return study::frames_of_files(options.reference, first);
  const std::uint32_t last = number(*range.last);
  // Before the names of all frames are made, which may be very many.
  if (last > first) check_files({core::numbered(options.reference, last - 1)}, {});
  return {first, last};
}

study::FlickerRequest request_of(const FlickerOptions& options) {
  if (!options.labels.empty() && options.labels.size() != options.sequences.size()) {
    throw Error(ErrorCode::usage,
                fmt::format("--label: {} for {}; give one for each",
                            core::counted(options.labels.size(), "is", "are"),
                            core::counted(options.sequences.size(), "sequence", "sequences")));
  }
  study::FlickerRequest request;
  for (std::size_t k = 0; k < options.sequences.size(); ++k) {
    request.sequences.push_back(study::sequence_of_files(
        options.sequences[k], options.labels.empty() ? "" : options.labels[k]));
  }
  request.reference = study::sequence_of_files(options.reference, "reference");
  request.frames = frames_of(options);
  request.epsilon = options.epsilon;
  request.trim = parse_trim(options.trim);
  request.with_sheet = !options.sheets.empty();
  request.columns = options.columns;
  request.exposure = options.exposure;
  return request;
}

void print_flicker(const study::FlickerRequest& request, const study::FlickerResult& result) {
  fmt::print("{:>12}{:>12}  frames {}:{}\n", "error", "flicker", request.frames.first,
             request.frames.last);
  for (const study::FlickerRow& row : result.rows) {
    fmt::print("{:>12.4g}{:>12.4g}  {}{}\n", row.error, row.flicker, row.label,
               row.left_out == 0 ? ""
                                 : fmt::format("; {} not finite, left out",
                                               core::counted(row.left_out, "pixel", "pixels")));
  }
}

void run(const FlickerOptions& options) {
  const core::ThreadLimit threads(options.common.threads);
  study::FlickerRequest request = request_of(options);
  std::vector<study::PictureSequence> all = request.sequences;
  all.push_back(request.reference);
  std::vector<std::string> outputs = options.sheets;
  outputs.push_back(options.common.json);
  check_files(study::files_of(all, request.frames), outputs);
  core::Progress progress("flicker", options.common.quiet);
  request.on_progress = [&](std::uint64_t done, std::uint64_t total) {
    progress.advance(done, total);
  };
  const study::FlickerResult result = study::measure_flicker(request);
  progress.finish();
  for (const std::string& path : options.sheets) result.sheet->write(path);
  if (!options.common.json.empty()) {
    core::write_json_file(options.common.json, study::to_json(request, result));
  }
  print_flicker(request, result);
  for (const std::string& path : options.sheets) fmt::print("wrote {}\n", path);
}

}  // namespace

void add_flicker(CLI::App& app) {
  auto options = std::make_shared<FlickerOptions>();
  CLI::App* command = app.add_subcommand(
      "flicker", "print the error of sequences of pictures, and how it changes between frames");
  command
      ->add_option("PICTURES", options->sequences,
                   "EXR pictures of a sequence, with #### for the frame's number; several are rows")
      ->required()
      ->type_name("FILE.exr");
  command
      ->add_option("--reference", options->reference,
                   "what is right: an EXR a frame, with #### for its number")
      ->required()
      ->type_name("FILE.exr");
  command
      ->add_option("--frames", options->frames,
                   "these frames, LAST not included; from 0 on, and as far as the reference goes, "
                   "unless given")
      ->type_name("FIRST:LAST");
  command
      ->add_option("--label", options->labels,
                   "name of a row, in the order of PICTURES; repeatable")
      ->type_name("NAME")
      ->expected(1)
      ->take_all();
  command->add_option("--epsilon", options->epsilon, "of the relative error: guards dark places")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option(
          "--trim", options->trim,
          "leave out of error and flicker this share of the pixels, where each is largest: "
          "1%")
      ->type_name("SHARE");
  command
      ->add_option("--sheet", options->sheets,
                   "write a contact sheet: some frames of each row, and where it flickers")
      ->type_name("FILE.png")
      ->expected(1)
      ->take_all();
  command->add_option("--exposure", options->exposure, "of the sheet: stops to brighten it")
      ->capture_default_str();
  add_number(*command, "--columns", options->columns, std::size_t{1},
             "frames of a row on the sheet");
  add_common(*command, options->common);
  wrap_descriptions(*command);
  set_example(*command, "psf flicker alone.####.exr window.####.exr --reference truth.####.exr");
  command->callback([options] { run(*options); });
}

}  // namespace psf::tools
