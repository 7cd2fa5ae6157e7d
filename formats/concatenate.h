// Joins path-vertex buffers of the same scene and changes how they are stored.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/writer.h"

namespace psf::formats {

struct ConcatenateOptions {
  std::optional<Codec> codec;         // of all columns; not set: each as it is stored
  std::vector<std::string> channels;  // to keep; empty: all. Those that the format requires stay
  std::vector<std::string> drop;      // to leave out
  std::vector<std::string> quantize;  // `normal` and `direction` to octahedral, others to f16
  std::uint64_t first_pass = 0;       // of all passes, counted through the inputs
  std::optional<std::uint64_t> last_pass;  // not included; not set: to the end
  bool sync = true;
};

struct ConcatenateReport {
  std::uint64_t records = 0, passes = 0, bytes = 0;
  std::uint64_t overflows = 0;     // finite values that became infinite as f16
  std::vector<std::string> notes;  // what is allowed and yet worth a look, a line each
};

// Writes the committed passes of `inputs`, in their order and numbered anew, to `output`, closed,
// which appears under its name when whole; it may be one of the inputs. Metadata are those of the
// first input; of several, `joined` tells uuid, seed, producer and passes of each. One input with
// all its passes keeps its resume state. Columns that stay as they are are copied as stored.
// Throws Error{bad_input} where the inputs are not of the same scene, cameras and channels, or one
// is damaged or lacks a channel; Error{usage} naming passes that there are not; Error{io}.
// `progress(done, total)` in records, from the calling thread; may throw to stop.
[[nodiscard]] ConcatenateReport concatenate(
    std::span<const std::string> inputs, const std::string& output,
    const ConcatenateOptions& options = {},
    const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

}  // namespace psf::formats
