#include "psf/flicker.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "core/apart.h"
#include "core/error.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "psf/library.h"
#include "psf/study_parts.h"
#include "study/flicker.h"

namespace psf {
namespace {

film::Picture to_film(const Picture& picture, const std::string& name) {
  film::Picture result;
  result.path = picture.file.empty() ? name : picture.file;
  result.width = picture.width;
  result.height = picture.height;
  if (result.width == 0 || result.height == 0) {
    throw Error(ErrorCode::usage, result.path + ": has no pixels");
  }
  result.colors = colors_of(picture);
  return result;
}

study::PictureSequence to_study(const PictureSequence& sequence, const char* otherwise,
                                std::uint32_t first) {
  if (!sequence.files.empty()) return study::sequence_of_files(sequence.files, sequence.label);
  const std::string label = sequence.label.empty() ? otherwise : sequence.label;
  return {label, "", [label, first, pictures = sequence.pictures](std::uint32_t frame) {
            return to_film(pictures[frame - first], fmt::format("frame {} of {}", frame, label));
          }};
}

study::FrameSpan frames_of(const PictureSequence& reference, const FlickerOptions& options) {
  const std::uint32_t first = options.first_frame;
  if (options.last_frame) return {first, *options.last_frame};
  if (!reference.files.empty()) return study::frames_of_files(reference.files, first);
  return {first, first + static_cast<std::uint32_t>(reference.pictures.size())};
}

// Of pictures in memory there are as many as frames.
void check_count(const PictureSequence& sequence, const std::string& label,
                 const study::FrameSpan& frames) {
  if (!sequence.files.empty() || sequence.pictures.size() == frames.count()) return;
  throw Error(ErrorCode::usage,
              fmt::format("{}: {} pictures for the frames {}:{}; give one each", label,
                          sequence.pictures.size(), frames.first, frames.last));
}

// The files that pictures in memory were read from.
void add_files(const PictureSequence& sequence, std::vector<std::string>& inputs) {
  for (const Picture& picture : sequence.pictures) {
    if (!picture.file.empty()) inputs.push_back(absolute(picture.file));
  }
}

}  // namespace

FlickerResult flicker(std::span<const PictureSequence> sequences, const PictureSequence& reference,
                      const FlickerOptions& options) {
  study::FlickerRequest request;
  request.reference = to_study(reference, "reference", options.first_frame);
  request.frames = frames_of(reference, options);
  check_count(reference, request.reference.label, request.frames);
  for (const PictureSequence& sequence : sequences) {
    request.sequences.push_back(to_study(sequence, "pictures", options.first_frame));
    check_count(sequence, request.sequences.back().label, request.frames);
  }
  request.epsilon = options.epsilon;
  request.trim = options.trim;
  request.with_sheet = true;
  request.columns = options.columns;
  request.exposure = options.exposure;
  request.on_progress = options.on_progress;
  const study::FlickerResult measured = study::measure_flicker(request);

  FlickerResult result;
  for (const study::FlickerRow& row : measured.rows) {
    result.rows.push_back({row.label, row.error, row.flicker, row.left_out});
  }
  result.json = core::json_file_text(study::to_json(request, measured));
  result.png = measured.sheet->png();
  std::vector<study::PictureSequence> all = request.sequences;
  all.push_back(request.reference);
  for (const std::string& file : study::files_of(all, request.frames)) {
    result.inputs.push_back(absolute(file));
  }
  for (const PictureSequence& sequence : sequences) add_files(sequence, result.inputs);
  add_files(reference, result.inputs);
  return result;
}

void FlickerResult::save(const std::string& path) const {
  core::check_files(inputs, {path});
  core::write_text_file(path, std::string(png.begin(), png.end()));
}

}  // namespace psf
