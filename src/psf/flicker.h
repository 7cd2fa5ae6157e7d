// How much the error of a sequence of pictures changes from frame to frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "psf/error.h"
#include "psf/export.h"
#include "psf/picture.h"

namespace psf {

// A picture a frame: files, or pictures in memory.
struct PictureSequence {
  std::string files;                  // their name, "####" for the frame's number; empty: none
  std::span<const Picture> pictures;  // borrowed; of all the frames that are measured, in order
  std::string label = {};             // of its row; empty: the name of the files
};

// Which frames flicker() takes, what it measures and what it shows.
struct FlickerOptions {
  std::uint32_t first_frame = 0;            // the first one
  std::optional<std::uint32_t> last_frame;  // behind the last; not set: all that the reference has
  double epsilon = 1e-2;                    // of the relative error: guards dark places
  double trim = 0;                          // share of the pixels left out, where each is largest
  float exposure = 0;                       // of the sheet: stops
  std::size_t columns = 4;                  // frames of a row on the sheet
  // Called now and then by the thread that works, with numbers of frames.
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress = {};
};

// What flicker() measured of a sequence.
struct FlickerRow {
  std::string label;         // of the sequence
  double error = 0;          // relMSE, mean over the frames
  double flicker = 0;        // variance of the error's change from frame to frame, mean over pixels
  std::size_t left_out = 0;  // pixels that are not finite in one of the frames
};

// What flicker() measured.
struct FlickerResult {
  std::vector<FlickerRow> rows;     // in the order of the sequences
  std::string json;                 // the bytes of psf flicker --json
  std::vector<unsigned char> png;   // the bytes of the sheet
  std::vector<std::string> inputs;  // the files that it was made of

  // Writes the sheet to a file, whole or not at all. Throws Error{usage} where that is one of
  // `inputs`, Error{io}.
  PSF_API void save(const std::string& path) const;
};

// What psf flicker does: error and flicker of each sequence against a reference a frame. Pictures
// of files are read frame after frame. Throws Error{usage} for fewer than 3 frames and for
// sequences of another number of pictures, Error{bad_input} for pictures that cannot be compared,
// Error{io}, Error{interrupted}.
[[nodiscard]] PSF_API FlickerResult flicker(std::span<const PictureSequence> sequences,
                                            const PictureSequence& reference,
                                            const FlickerOptions& options = {});

}  // namespace psf
