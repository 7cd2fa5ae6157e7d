#include "study/flicker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/numbered_name.h"
#include "core/text.h"
#include "metrics/flicker.h"

namespace psf::study {
namespace {

constexpr std::uint32_t kFewestFrames = 3;  // two changes, which have a variance

// What a sequence shows and how it flickers.
struct FlickerSection {
  const PictureSequence* of;
  std::optional<metrics::Flicker> measured;  // none: the reference
  std::vector<std::pair<std::uint32_t, film::Picture>> shown;
};

void check_flicker(const FlickerRequest& request) {
  if (request.sequences.empty()) {
    throw Error(ErrorCode::usage, "`pictures`: at least one sequence is needed");
  }
  const auto& [first, last] = request.frames;
  if (last < first || last - first < kFewestFrames) {
    throw Error(ErrorCode::usage, fmt::format("`frames`: {}:{}: flicker takes at least {}", first,
                                              last, kFewestFrames));
  }
  if (!(request.trim >= 0 && request.trim < 1)) {
    throw Error(
        ErrorCode::usage,
        fmt::format("`trim`: {}: is a share of the pixels, at least 0 and below 1", request.trim));
  }
  if (request.columns == 0) throw Error(ErrorCode::usage, "`columns`: at least one is needed");
}

// The frames that the sheet shows: evenly spaced, the first and the last among them.
std::set<std::uint32_t> shown_frames(const FlickerRequest& request) {
  std::set<std::uint32_t> shown;
  const auto& [first, last] = request.frames;
  const std::uint64_t most = std::min<std::uint64_t>(request.columns, request.frames.count());
  const std::uint64_t steps = most > 1 ? most - 1 : 1;
  for (std::uint64_t k = 0; k < most; ++k) {
    shown.insert(first + static_cast<std::uint32_t>(k * (last - 1 - first) / steps));
  }
  return shown;
}

// Takes in a frame of all sequences; those that are `shown` are kept.
void add_frame(const FlickerRequest& request, std::uint32_t frame, bool shown,
               std::vector<FlickerSection>& rows, FlickerSection& reference,
               std::optional<film::Picture>& first) {
  film::Picture truth = request.reference.picture(frame);
  if (!first) first = truth;
  static_cast<void>(film::check_comparable(truth, *first));
  for (FlickerSection& row : rows) {
    film::Picture picture = row.of->picture(frame);
    static_cast<void>(film::check_comparable(picture, truth));
    if (!row.measured) row.measured.emplace(truth.colors.size(), request.epsilon);
    row.measured->add(picture.colors, truth.colors);
    if (shown) row.shown.emplace_back(frame, std::move(picture));
  }
  if (shown) reference.shown.emplace_back(frame, std::move(truth));
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

film::ContactSheet flicker_sheet(const FlickerRequest& request,
                                 const std::vector<FlickerSection>& rows,
                                 const FlickerSection& reference) {
  const film::Picture& first = reference.shown.front().second;
  film::SheetOptions options;
  options.columns = reference.shown.size() + 1;
  options.exposure = request.exposure;
  film::ContactSheet sheet(first.width, first.height, options);
  const std::string trimmed =
      request.trim == 0 ? "" : fmt::format(", without {:g}% of the pixels", 100 * request.trim);
  const std::string& truth =
      request.reference.files.empty() ? request.reference.label : request.reference.files;
  sheet.set_head({"Error and flicker",
                  fmt::format("frames {}:{}, epsilon {:g}{}, against {}", request.frames.first,
                              request.frames.last, request.epsilon, trimmed, truth)});
  double most = 0;
  for (const FlickerSection& row : rows) most = std::max(most, largest_shown(*row.measured));
  const auto add = [&](const FlickerSection& section) {
    sheet.add_section(section.of->label);
    for (const auto& [frame, picture] : section.shown) {
      sheet.add(picture.colors, fmt::format("frame {}", frame), "");
    }
  };
  for (const FlickerSection& row : rows) {
    add(row);
    sheet.add(flicker_picture(*row.measured, most, request.exposure), "where it flickers",
              fmt::format("error {:.3g}, flicker {:.3g}", row.measured->error(request.trim),
                          row.measured->flicker(request.trim)));
  }
  add(reference);
  return sheet;
}

}  // namespace

PictureSequence sequence_of_files(const std::string& files, const std::string& label) {
  if (!core::is_numbered(files)) {
    throw Error(ErrorCode::usage,
                fmt::format("{}: a sequence has {} in its name, for the frame's number", files,
                            core::kNumberMark));
  }
  return {label.empty() ? files : label, files, [files](std::uint32_t frame) {
            return film::read_picture(core::numbered(files, frame));
          }};
}

FrameSpan frames_of_files(const std::string& files, std::uint32_t first) {
  FrameSpan span{first, first};
  while (std::filesystem::exists(core::numbered(files, span.last))) ++span.last;
  if (span.count() >= kFewestFrames) return span;
  throw Error(
      ErrorCode::usage,
      fmt::format("{}: has {} from {} on, and flicker takes at least {}; say which by "
                  "`frames`",
                  files, core::counted(span.count(), "frame", "frames"), first, kFewestFrames));
}

std::vector<std::string> files_of(const std::vector<PictureSequence>& sequences,
                                  const FrameSpan& frames) {
  std::vector<std::string> files;
  for (const PictureSequence& sequence : sequences) {
    if (sequence.files.empty()) continue;
    for (std::uint32_t frame = frames.first; frame < frames.last; ++frame) {
      files.push_back(core::numbered(sequence.files, frame));
    }
  }
  return files;
}

FlickerResult measure_flicker(const FlickerRequest& request) {
  check_flicker(request);
  const FrameSpan& frames = request.frames;
  const std::set<std::uint32_t> shown =
      request.with_sheet ? shown_frames(request) : std::set<std::uint32_t>();
  std::vector<FlickerSection> rows;
  for (const PictureSequence& sequence : request.sequences) rows.push_back({&sequence, {}, {}});
  FlickerSection reference{&request.reference, {}, {}};
  std::optional<film::Picture> first;
  for (std::uint32_t frame = frames.first; frame < frames.last; ++frame) {
    core::throw_if_interrupted("nothing was written");
    add_frame(request, frame, shown.contains(frame), rows, reference, first);
    if (request.on_progress) request.on_progress(frame + 1 - frames.first, frames.count());
  }
  FlickerResult result;
  for (const FlickerSection& row : rows) {
    result.rows.push_back({row.of->label, row.of->files, row.measured->error(request.trim),
                           row.measured->flicker(request.trim), row.measured->left_out()});
  }
  if (request.with_sheet) result.sheet = flicker_sheet(request, rows, reference);
  return result;
}

Json to_json(const FlickerRequest& request, const FlickerResult& result) {
  const auto name_or_null = [](const std::string& files) {
    return files.empty() ? Json(nullptr) : Json(files);
  };
  Json list = Json::array();
  for (const FlickerRow& row : result.rows) {
    list.push_back({{"pictures", name_or_null(row.files)},
                    {"label", row.label},
                    {"error", row.error},
                    {"flicker", row.flicker},
                    {"left_out", row.left_out}});
  }
  return {{"reference", name_or_null(request.reference.files)},
          {"first", request.frames.first},
          {"last", request.frames.last},
          {"epsilon", request.epsilon},
          {"trim", request.trim},
          {"rows", list}};
}

}  // namespace psf::study
