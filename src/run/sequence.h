// The frames of a sequence, all in one dump or in a dump each.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "run/dump.h"
#include "run/window.h"

namespace psf::run {

class Sequence {
 public:
  // `path`: a dump, or the name of one a frame, with core::kNumberMark for its number. Throws what
  // Dump throws; Error{usage} where the dump tells of no frames, Error{io} where no file has the
  // name.
  explicit Sequence(const std::string& path, const std::optional<VertexRule>& rule = {});

  // Ascending; of a dump that is not whole yet those that have a pass.
  [[nodiscard]] const std::vector<std::uint32_t>& frames() const { return frames_; }
  // A frame, with the cameras that it has; the dump lives as long as somebody has it. Throws
  // Error{usage} where there is no such frame.
  [[nodiscard]] DumpFrame frame(std::uint32_t number) const;
  // What is taken in around a frame of `dump`: the frames of its window but for itself, without
  // those that the sequence does not have. Throws what frame() and WindowTexts throw.
  [[nodiscard]] Window around(std::uint32_t number, const Dump& dump,
                              const WindowTexts& texts) const;
  // The same sequence with another choice of x_i; none: what the file says. Throws what Dump::at()
  // throws.
  [[nodiscard]] Sequence at(const std::optional<VertexRule>& rule) const;
  // The name as given, for messages.
  [[nodiscard]] const std::string& path() const { return path_; }
  // The files that hold the frames.
  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }

 private:
  void find_files();

  std::string path_;
  std::optional<VertexRule> rule_;
  std::vector<std::uint32_t> frames_;
  std::vector<std::string> files_;
  std::shared_ptr<const Dump> whole_;  // where one dump has them all
};

}  // namespace psf::run
