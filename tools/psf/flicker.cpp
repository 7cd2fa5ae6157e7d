// psf flicker: the error of sequences of pictures, and how much it changes from frame to frame.
#include "metrics/flicker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cli.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/json_text.h"
#include "core/numbered_name.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/text.h"
#include "film/contact_sheet.h"
#include "film/picture.h"
#include "notes.h"
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
  double epsilon = 1e-2;
  std::string trim;  // as written; empty: nothing
  double share = 0;  // the same
  std::vector<std::string> sheets;
  float exposure = 0;
  std::size_t columns = 4;
};

struct Row {
  std::string name;
  metrics::Flicker measured;
  std::vector<std::pair<std::uint32_t, film::Picture>> shown;  // for the sheet
};

// Frames first ... last - 1, of which every sequence has a file.
struct FrameSpan {
  std::uint32_t first = 0, last = 0;
};

FrameSpan frames_of(const FlickerOptions& options) {
  constexpr std::uint64_t kLeast = 3, kMost = std::numeric_limits<std::uint32_t>::max();
  const NumberRange range = parse_range(options.frames, "--frames");
  std::uint64_t last = range.last.value_or(range.first);
  const auto exists = [&](std::uint64_t f) {
    return std::filesystem::exists(
        core::numbered(options.reference, static_cast<std::uint32_t>(f)));
  };
  while (!range.last && last < kMost && exists(last)) ++last;
  if (last > kMost) {
    throw Error(ErrorCode::usage, fmt::format("--frames: {} are the most", kMost));
  }
  if (last < range.first || last - range.first < kLeast) {
    throw Error(
        ErrorCode::usage,
        range.last
            ? fmt::format("--frames: '{}': flicker takes at least {} frames", options.frames,
                          kLeast)
            : fmt::format("{}: has {} from {} on, and flicker takes at least {}; say which by "
                          "--frames FIRST:LAST",
                          options.reference, core::counted(last - range.first, "frame", "frames"),
                          range.first, kLeast));
  }
  return {static_cast<std::uint32_t>(range.first), static_cast<std::uint32_t>(last)};
}

void check(const FlickerOptions& options, const FrameSpan& span) {
  std::vector<std::string> inputs;
  std::vector<std::string> names = options.sequences;
  names.push_back(options.reference);
  for (const std::string& name : names) {
    if (!core::is_numbered(name)) {
      throw Error(ErrorCode::usage,
                  fmt::format("{}: a sequence has {} in its name, for the frame's "
                              "number",
                              name, core::kNumberMark));
    }
    for (std::uint32_t f = span.first; f < span.last; ++f) {
      inputs.push_back(core::numbered(name, f));
    }
  }
  if (!options.labels.empty() && options.labels.size() != options.sequences.size()) {
    throw Error(ErrorCode::usage,
                fmt::format("--label: {} for {}; give one for each",
                            core::counted(options.labels.size(), "is", "are"),
                            core::counted(options.sequences.size(), "sequence", "sequences")));
  }
  std::vector<std::string> outputs = options.sheets;
  outputs.push_back(options.common.json);
  check_files(inputs, outputs);
}

// The frames that the sheet shows: evenly spaced, the first and the last among them.
std::set<std::uint32_t> shown_frames(const FlickerOptions& options, const FrameSpan& span) {
  std::set<std::uint32_t> shown;
  const std::uint64_t steps = options.columns > 1 ? options.columns - 1 : 1;
  for (std::uint64_t k = 0; k < options.columns; ++k) {
    shown.insert(span.first + static_cast<std::uint32_t>(k * (span.last - 1 - span.first) / steps));
  }
  return shown;
}

film::Picture read_alike(const std::string& path, const film::Picture& like) {
  film::Picture picture = film::read_picture(path);
  static_cast<void>(film::check_comparable(picture, like));
  return picture;
}

// Reads all pictures, frame after frame.
void measure(const FlickerOptions& options, const FrameSpan& span, std::vector<Row>& rows,
             Row& reference) {
  const std::set<std::uint32_t> shown =
      options.sheets.empty() ? std::set<std::uint32_t>() : shown_frames(options, span);
  core::Progress progress("flicker", options.common.quiet);
  std::optional<film::Picture> first;
  for (std::uint32_t f = span.first; f < span.last; ++f) {
    core::throw_if_interrupted("nothing was written");
    film::Picture truth = film::read_picture(core::numbered(options.reference, f));
    if (!first) first = truth;
    static_cast<void>(film::check_comparable(truth, *first));
    for (std::size_t k = 0; k < options.sequences.size(); ++k) {
      film::Picture picture = read_alike(core::numbered(options.sequences[k], f), truth);
      if (rows.size() <= k) {
        rows.push_back({options.labels.empty() ? options.sequences[k] : options.labels[k],
                        metrics::Flicker(truth.colors.size(), options.epsilon),
                        {}});
      }
      rows[k].measured.add(picture.colors, truth.colors);
      if (shown.contains(f)) rows[k].shown.emplace_back(f, std::move(picture));
    }
    if (shown.contains(f)) reference.shown.emplace_back(f, std::move(truth));
    progress.advance(f + 1 - span.first, span.last - span.first);
  }
  progress.finish();
}

double largest_shown(const metrics::Flicker& measured) {
  constexpr double kShare = 0.99;
  std::vector<double> values = measured.map();
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Where a sequence flickers: white where it does by `most` or more.
std::vector<Rgb> flicker_picture(const metrics::Flicker& measured, double most, float exposure) {
  std::vector<Rgb> picture;
  for (const double value : measured.map()) {
    const double share = most > 0 ? std::min(1.0, value / most) : 0;
    const auto grey = static_cast<float>(share * std::exp2(-double{exposure}));
    picture.emplace_back(grey, grey, grey);
  }
  return picture;
}

void write_sheets(const FlickerOptions& options, const FrameSpan& span,
                  const std::vector<Row>& rows, const Row& reference) {
  if (options.sheets.empty()) return;
  const film::Picture& first = reference.shown.front().second;
  film::SheetOptions sheet_options;
  sheet_options.columns = reference.shown.size() + 1;
  sheet_options.exposure = options.exposure;
  film::ContactSheet sheet(first.width, first.height, sheet_options);
  const std::string trimmed =
      options.trim.empty() ? "" : fmt::format(", without {} of the pixels", options.trim);
  sheet.set_head(
      {"Error and flicker", fmt::format("frames {}:{}, epsilon {:g}{}, against {}", span.first,
                                        span.last, options.epsilon, trimmed, options.reference)});
  double most = 0;
  for (const Row& row : rows) most = std::max(most, largest_shown(row.measured));
  const auto add = [&](const Row& row) {
    sheet.add_section(row.name);
    for (const auto& [frame, picture] : row.shown) {
      sheet.add(picture.colors, fmt::format("frame {}", frame), "");
    }
  };
  for (const Row& row : rows) {
    add(row);
    sheet.add(flicker_picture(row.measured, most, options.exposure), "where it flickers",
              fmt::format("error {:.3g}, flicker {:.3g}", row.measured.error(options.share),
                          row.measured.flicker(options.share)));
  }
  add(reference);
  for (const std::string& path : options.sheets) sheet.write(path);
}

nlohmann::ordered_json to_json(const FlickerOptions& options, const FrameSpan& span,
                               const std::vector<Row>& rows) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    list.push_back({{"pictures", options.sequences[k]},
                    {"label", rows[k].name},
                    {"error", rows[k].measured.error(options.share)},
                    {"flicker", rows[k].measured.flicker(options.share)},
                    {"left_out", rows[k].measured.left_out()}});
  }
  return {{"reference", options.reference}, {"first", span.first},   {"last", span.last},
          {"epsilon", options.epsilon},     {"trim", options.share}, {"rows", list}};
}

void run(const FlickerOptions& given) {
  FlickerOptions options = given;
  options.share = parse_trim(options.trim);
  const core::ThreadLimit threads(options.common.threads);
  const FrameSpan span = frames_of(options);
  check(options, span);
  std::vector<Row> rows;
  Row reference{"reference", metrics::Flicker(0, options.epsilon), {}};
  measure(options, span, rows, reference);
  write_sheets(options, span, rows, reference);
  if (!options.common.json.empty()) {
    core::write_json_file(options.common.json, to_json(options, span, rows));
  }
  fmt::print("{:>12}{:>12}  frames {}:{}\n", "error", "flicker", span.first, span.last);
  for (const Row& row : rows) {
    fmt::print("{:>12.4g}{:>12.4g}  {}{}\n", row.measured.error(options.share),
               row.measured.flicker(options.share), row.name,
               row.measured.left_out() == 0
                   ? ""
                   : fmt::format("; {} not finite, left out",
                                 core::counted(row.measured.left_out(), "pixel", "pixels")));
  }
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
