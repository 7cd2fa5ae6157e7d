// Saves the undamaged chunks of a path-vertex buffer into a new one.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "formats/check/check.h"

namespace psf::formats {

struct RecoverOptions {
  // Save whole chunks behind the last commit too: records of a pass that was not finished.
  bool uncommitted = false;
};

struct RecoverResult {
  std::uint64_t records_saved = 0, chunks_saved = 0, passes_saved = 0;
  std::uint64_t records_lost = 0;       // committed paths that were not saved
  std::uint64_t uncommitted_bytes = 0;  // not saved; normal after a kill
  bool head_restored = false;           // HEAD was unreadable; a commit's copy was used
  std::vector<Fault> faults;            // faults of the input, as check() finds them, by offset
  std::vector<Fault> losses;            // committed data that are not in the output, in order

  // Whether every record that was ever committed is in the output.
  [[nodiscard]] bool nothing_lost() const { return losses.empty(); }
};

// Copies the chunks of `in` whose columns are all whole to `out`, as they are stored; of a table
// those of passes that are all whole, where all paths of the pass are, too. `out` gets a
// new uuid and one commit per pass, and is closed. Where some are missing, records and passes get
// new numbers. Where nothing is lost the resume state is kept, so that the producer can go on.
// `out` is read and checked before it gets its name. Calls `progress(done, total)` with bytes, from
// the calling thread; it may throw to stop.
// Throws Error{bad_input} where nothing can be saved, Error{io}, Error{usage} where `out` is `in`.
[[nodiscard]] RecoverResult recover(
    const std::string& in, const std::string& out, const RecoverOptions& options = {},
    const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

}  // namespace psf::formats
