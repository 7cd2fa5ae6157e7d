// Why a pixel of a filtered picture is what it is: its paths, whom each averaged, and what the
// weights refused.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "filter/parameters.h"
#include "filter/records.h"
#include "study/block_records.h"
#include "study/dump.h"
#include "study/passes.h"

namespace psf::study {

struct ExplainRequest {
  filter::Parameters parameters;  // estimator `average`, `adaptive` or `disk`
  PassSelection passes;
  std::size_t camera = 0;             // index
  std::uint32_t x = 0, y = 0;         // pixel, row 0 at the top
  std::optional<std::uint64_t> path;  // this record alone, whatever its pixel
  // Sources in the balls of all its paths, each pair counted: 24 bytes of memory, a few times that
  // as JSON.
  std::int64_t most_pairs = std::int64_t{1} << 25;
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress;  // paths
};

enum class PathFate : std::uint8_t {
  averaged,    // over the sources in its ball that pass the weights
  orphan,      // there was none: over the nearest instead
  no_vertex,   // contributes u_i alone
  left_out,    // a value in use is not finite, or its block has no source: no part of the pixel
  overflowed,  // alpha_i c_bar_i is not finite: no part of the pixel
};

// One of the pixel's paths.
struct ExplainedPath {
  std::uint32_t vertex = 0;  // its own place in Explanation::vertices
  PathFate fate = PathFate::averaged;
  bool is_input = false;  // the picture without filter is the mean of such paths
  float radius = 0;       // r_i, world units; of `adaptive`, that which it chose
  Rgb c_bar{0, 0, 0};
  std::uint32_t neighbors = 0;     // sources averaged; 0 for an orphan
  double scale = 1;                // of the sum over its sources: 1 / how many, or 1 / (pi r_i^2)
  std::size_t begin = 0, end = 0;  // its pairs
  std::uint32_t in_ball = 0;       // pairs with chi = 1, itself included
};

// A path i and a source j in its ball, or adopted. The path itself is one where it is a source.
struct ExplainedPair {
  std::uint32_t path = 0, vertex = 0;  // places in Explanation::paths, ::vertices
  float distance = 0;                  // of x_j from x_i, world units
  std::uint32_t refusers = 0;          // bit k: term k of filter::kTermNames; 0 for the path itself
  float area = 1;                      // A_j of [disk], 1 for [average]
  bool in_ball = false, averaged = false, self = false;
};

struct Explanation {
  ExplainRequest request;
  std::vector<std::uint32_t> widths;  // of the cameras' pictures
  std::uint64_t passes = 0;           // selected
  std::uint64_t blocks = 0;           // of them, those that hold a path of the pixel
  // Every record that plays a part, once, in the order of the dump: all channels that the file has
  // of those that a term can look at.
  BlockRecords vertices;
  std::vector<std::uint64_t> record;  // of each vertex: its number in the dump
  std::vector<std::uint32_t> pass;
  std::vector<bool> is_source;
  std::vector<Rgb>
      value;  // what is averaged of it: c_j, c_j / rho_j, or that of an iteration before
  std::vector<ExplainedPath> paths;  // in the order of the dump
  std::vector<ExplainedPair> pairs;  // by path, then by record
};

// Reads the pixels of all paths of the selection, and all of the blocks that hold one of this
// pixel. What it says is what psf filter does with the same parameters; of several iterations the
// last one. Throws Error{usage} for a camera, pixel, path or passes that the dump does not have and
// for other estimators, Error{bad_input} where no path falls into the pixel, what filter_dump()
// throws, Error{limit} above `most_pairs`, Error{interrupted}.
[[nodiscard]] Explanation explain(const Dump& dump, const ExplainRequest& request);

}  // namespace psf::study
