// Sequences of frames: filtered frame by frame, each with the vertices of those around it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "psf/dump.h"
#include "psf/error.h"
#include "psf/export.h"
#include "psf/filter.h"
#include "psf/parameters.h"

namespace psf {

// How a frame is filtered, beside the parameters of the filter.
struct FrameOptions {
  std::uint32_t window = 1;  // share vertices over so many frames, an odd number
  // As --relit of psf filter: a ball of another frame counts where the means differ by at most so
  // many standard errors, "1.5", or "off"; empty: the default of the command.
  std::string relit = {};
  // As --positions of psf filter: where other frames are searched, at the places of frame 0,
  // "rest", or of now, "world"; empty: "rest" where the dump has rest_position.
  std::string positions = {};
  bool layers = true;                       // all layers of psf filter, not the colours alone
  std::optional<std::uint64_t> max_memory;  // bytes; where they do not suffice: Error{limit}
  // As --vertex of the commands: "first-rough", "depth:K", "roughness:T", "distance:D"; empty: the
  // vertex of the file.
  std::string vertex = {};
  // Called now and then by the thread that filters, with numbers of paths of the frame.
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress = {};
};

// The frames of a sequence, all in one dump or in a dump each. A value that may be copied. Several
// threads may call it at once.
class PSF_API Sequence {
 public:
  // Opens a dump that tells of frames, up to its last commit, or the dumps of a name with "####" for
  // the frame's number. Throws what Dump throws, Error{usage} where the dump tells of no frames,
  // Error{io} where no file has the name.
  explicit Sequence(const std::string& path);

  [[nodiscard]] const std::string& path() const;                   // as it was opened
  [[nodiscard]] const std::vector<std::uint32_t>& frames() const;  // ascending
  [[nodiscard]] const std::vector<Camera>& cameras() const;        // of the first frame

  // What psf filter --frame does: the pictures of a frame, one a camera. Throws what Dump::filter()
  // throws, and Error{usage} where there is no such frame.
  [[nodiscard]] FilterResult filter(std::uint32_t frame, const Parameters& parameters = {},
                                    const FrameOptions& options = {}) const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace psf
