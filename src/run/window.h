// The frames around a frame, whose vertices count for its picture too: filter/README.md, "Windows
// of frames".
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "filter/parameters/parameters.h"
#include "filter/window.h"
#include "run/block_loop.h"
#include "run/dump.h"
#include "run/passes.h"

namespace psf::run {

// A frame of a sequence: its passes, and the dump that has them.
struct DumpFrame {
  std::shared_ptr<const Dump> dump;
  PassSelection passes;
};

struct Window {
  std::uint32_t width = 1;        // frames, odd; at the ends of a sequence there are fewer
  std::vector<DumpFrame> others;  // ascending; empty: the frame is filtered alone
  filter::WindowTerms terms;
};

// The same as users write it, for a sequence of frames.
struct WindowTexts {
  std::uint32_t width = 1;  // frames, the frame itself in their middle
  std::string relit;        // "1.5" or "off"; empty: what WindowTerms has
  std::string positions;    // "rest" or "world"; empty: rest where the dump has rest_position

  // Throws Error{usage} for what is none of these, and for texts about other frames where the width
  // is 1.
  void validate() const;
  // Of a frame of `dump`. Throws what validate() throws.
  [[nodiscard]] filter::WindowTerms terms(const Dump& dump) const;
};

// How other frames are taken in, by name; empty: there are none.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> describe(const Window& window);

// Throws Error{bad_input} for a frame that the run's own cannot share with, Error{usage} for
// parameters that do not go with other frames.
void check_window(const Dump& dump, const Window& window, const filter::Parameters& parameters);

// Filters blocks of one frame with the paths of the others that lie at the same place in theirs.
class WindowReader {
 public:
  using Select = std::function<ChannelSet(const Dump&)>;

  // `first_path`: of the frame itself. `select`: the channels of a dump. All must outlive it.
  // Throws what `select` throws, and Error{bad_input} where a dump has other layers of the light.
  WindowReader(std::uint64_t first_path, const Window& window, const filter::Parameters& parameters,
               const Select& select);

  // What filter::estimate() gives for the block of `visit`, with the other frames. Throws
  // Error{interrupted} and what Dump::read() throws.
  [[nodiscard]] filter::Estimates estimate(const BlockLoop::Visit& visit,
                                           std::span<const float> radius);
  [[nodiscard]] const filter::WindowCounts& counts() const { return counts_; }
  [[nodiscard]] double seconds_read() const { return seconds_; }

 private:
  std::uint64_t first_path_;
  const Window& window_;
  const filter::Parameters& parameters_;
  std::vector<ChannelSet> channels_;  // by frame
  BlockRecords records_;              // of the frame that is taken in
  filter::WindowCounts counts_;
  double seconds_ = 0;
};

}  // namespace psf::run
