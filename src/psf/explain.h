// Why a pixel of the filtered picture is what it is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "psf/error.h"
#include "psf/export.h"
#include "psf/passes.h"

namespace psf {

// What of a dump is explained, beside the pixel and the parameters of the filter.
struct ExplainOptions {
  Passes passes;           // the passes whose paths are explained
  std::size_t camera = 0;  // the pixel's; a path has its own
  // As --vertex of the commands: "first-rough", "depth:K", "roughness:T", "distance:D"; empty: the
  // vertex of the file.
  std::string vertex = {};
  // Called now and then by the thread that explains, with numbers of paths.
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress = {};
};

// A pixel, or a path, explained: Dump::explain(). A value, which keeps its dump open.
class PSF_API Explanation {
 public:
  // What psf explain prints, with so many rows a table.
  [[nodiscard]] std::string text(std::size_t rows = 5) const;
  // What psf explain --all prints: every row, and every path's vertex.
  [[nodiscard]] std::string whole_text() const;
  // What psf explain --json writes: everything, down to each neighbour.
  [[nodiscard]] std::string json() const;
  // What was switched off because the dump lacks its channel.
  [[nodiscard]] const std::vector<std::string>& notes() const;
  // Writes that JSON, or the vertices as a point cloud, by the extension .json or .ply. The file
  // appears whole or not at all. Throws Error{io}, Error{usage} for another extension.
  void save(const std::string& path) const;

 private:
  friend class Dump;
  struct State;
  explicit Explanation(std::shared_ptr<const State> state) : state_(std::move(state)) {}
  std::shared_ptr<const State> state_;
};

}  // namespace psf
