// Saves what is whole in a damaged path-vertex buffer into a new one.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "formats/check.h"

namespace psf::formats {

struct RecoverOptions {
  // Also chunks behind the last commit that are whole: records of a pass that was not finished.
  bool uncommitted = false;
};

struct RecoverReport {
  std::uint64_t records_saved = 0, chunks_saved = 0, passes_saved = 0;
  std::uint64_t records_lost = 0;       // that commits counted
  std::uint64_t uncommitted_bytes = 0;  // left behind: normal after a kill
  bool head_restored = false;           // HEAD was unreadable; a commit's copy stands for it
  std::vector<Fault> faults;  // what is wrong with the input, as check() has it, by offset
  std::vector<Fault> losses;  // what of it was committed and is not in the output, in order

  // Every record that was ever committed is in the output.
  [[nodiscard]] bool nothing_lost() const { return losses.empty(); }
};

// Writes the chunks of `in` whose columns are all whole to `out`, stored as they are, under a new
// uuid, closed, a commit a pass. Records are numbered anew where some are missing, passes too. With
// nothing lost the resume state is kept, so that the producer can go on. `out` is opened again and
// checked before it gets its name. `progress(done, total)` in bytes, from the calling thread; may
// throw to stop.
// Throws Error{bad_input} where nothing can be saved, Error{io}, Error{usage} where `out` is `in`.
[[nodiscard]] RecoverReport recover(
    const std::string& in, const std::string& out, const RecoverOptions& options = {},
    const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

}  // namespace psf::formats
