// The frames that psf filter is asked for: of a sequence one or all, with those around them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "filter_options.h"
#include "run/sequence.h"

namespace psf::tools {

// A run of the filter: a dump or a frame of it, and where its pictures go.
struct FrameRun {
  run::DumpFrame frame;
  std::optional<std::uint32_t> number;  // none: the dump is no sequence, or filtered as a whole
  run::Window window;
  std::vector<std::string> outputs;
};

class FrameRuns {
 public:
  // `vertex`: as written. Throws Error{usage} for options that do not go together, for frames that
  // there are not, and where frames would share a picture; and what Dump throws.
  FrameRuns(const FilterOptions& options, const std::string& vertex);

  [[nodiscard]] std::size_t count() const { return sequence_ ? frames_.size() : 1; }
  // Opens the dumps of a run. Throws what Sequence and Dump throw.
  [[nodiscard]] FrameRun operator[](std::size_t k) const;
  [[nodiscard]] const std::vector<std::uint32_t>& frames() const { return frames_; }
  // Files that are read.
  [[nodiscard]] std::vector<std::string> inputs() const;

 private:
  void choose_frames();

  const FilterOptions& options_;
  std::shared_ptr<const run::Dump> whole_;  // where there are no frames to choose from
  std::optional<run::Sequence> sequence_;
  std::vector<std::uint32_t> frames_;
};

}  // namespace psf::tools
