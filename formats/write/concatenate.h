// Joins path-vertex buffers of the same scene and changes how they are stored.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/write/writer_options.h"

namespace psf::formats {

struct ConcatenateOptions {
  std::optional<Codec> codec;  // for all columns; not set: each stays as it is stored
  // Of the paths, to keep; empty: all. Required channels are always kept.
  std::vector<std::string> channels;
  std::vector<std::string> drop;           // to leave out; a table's name: the table
  std::vector<std::string> quantize;       // `normal` and `direction` to octahedral, others to f16
  std::uint64_t first_pass = 0;            // number of a pass, counted through all inputs
  std::optional<std::uint64_t> last_pass;  // the pass behind the last one; not set: to the end
  bool sync = true;
};

struct ConcatenateResult {
  std::uint64_t records = 0, passes = 0, bytes = 0;
  std::uint64_t overflows = 0;     // finite values that became infinite as f16
  std::vector<std::string> notes;  // remarks about inputs that are allowed but unusual, a line each
};

// Writes the committed passes of `inputs`, in their order and with new numbers, to the closed file
// `output`, which appears under its name when whole and may be one of the inputs. The metadata are
// those of the first input; with several inputs, the key `joined` lists uuid, seed, producer and
// passes of each. Tables are copied as they are. A single input with all its passes keeps its resume state. Unchanged columns are
// copied as stored. Throws Error{bad_input} where the inputs differ in scene, cameras or channels,
// or one is damaged or lacks a channel, Error{usage} for passes that do not exist, Error{io}. Calls
// `progress(done, total)` with records, from the calling thread; it may throw to stop.
[[nodiscard]] ConcatenateResult concatenate(
    std::span<const std::string> inputs, const std::string& output,
    const ConcatenateOptions& options = {},
    const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

}  // namespace psf::formats
