// Sequences of pictures against a reference a frame: the error and the flicker of each
// (metrics/flicker.h), as rows, JSON and a contact sheet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "film/contact_sheet.h"
#include "film/picture.h"
#include "study/study_file.h"

namespace psf::study {

// Frames first ... last - 1.
struct FrameSpan {
  std::uint32_t first = 0, last = 0;
  [[nodiscard]] std::uint32_t count() const { return last - first; }
};

// A picture a frame.
struct PictureSequence {
  std::string label;
  std::string files;  // their name, with core::kNumberMark for the frame's number; empty: no files
  std::function<film::Picture(std::uint32_t frame)> picture;
};
// That of files. `label`: empty: their name. Throws Error{usage} for a name without the mark.
[[nodiscard]] PictureSequence sequence_of_files(const std::string& files,
                                                const std::string& label = "");

// The frames from `first` on, as far as there are files of a name that has the mark. Throws
// Error{usage} where there are fewer than 3.
[[nodiscard]] FrameSpan frames_of_files(const std::string& files, std::uint32_t first = 0);
// The files of `sequences`, of those that are of files.
[[nodiscard]] std::vector<std::string> files_of(const std::vector<PictureSequence>& sequences,
                                                const FrameSpan& frames);

struct FlickerRequest {
  std::vector<PictureSequence> sequences;  // a row each
  PictureSequence reference;               // what is right
  FrameSpan frames;
  double epsilon = 1e-2;
  double trim = 0;          // share of the pixels that is left out, in [0, 1)
  bool with_sheet = false;  // make FlickerResult::sheet
  std::size_t columns = 4;  // of the sheet: frames of a row, at least 1
  float exposure = 0;       // of the sheet, stops
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress;  // frames
};

struct FlickerRow {
  std::string label, files;  // as of its sequence
  double error = 0, flicker = 0;
  std::size_t left_out = 0;  // pixels that are not finite
};

struct FlickerResult {
  std::vector<FlickerRow> rows;
  // Some frames of each row, evenly spaced, and where it flickers: white where it does as much as
  // 99 in 100 pixels of the worst row do at most.
  std::optional<film::ContactSheet> sheet;
};

// Reads frame after frame and keeps what the sheet shows. Throws Error{usage} for fewer than 3
// frames, a trim or an epsilon that is none, Error{bad_input} for pictures that cannot be compared,
// Error{interrupted}, and what the pictures throw.
[[nodiscard]] FlickerResult measure_flicker(const FlickerRequest& request);

[[nodiscard]] Json to_json(const FlickerRequest& request, const FlickerResult& result);

}  // namespace psf::study
