// Explains a pixel of a filtered picture: its paths, the sources that each averaged, and the
// sources that the weights refused.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/vec.h"
#include "filter/parameters/parameters.h"
#include "filter/records.h"
#include "run/block_records.h"
#include "run/dump.h"
#include "run/passes.h"

namespace psf::explain {

using Colour = Imath::V3d;  // linear, Rec. 709 primaries

[[nodiscard]] inline Colour wide(const Vec3& v) {
  return {double{v.x}, double{v.y}, double{v.z}};
}

struct ExplainRequest {
  filter::Parameters parameters;  // estimator `average`, `adaptive` or `disk`
  run::PassSelection passes;
  std::size_t camera = 0;             // index
  std::uint32_t x = 0, y = 0;         // pixel, row 0 at the top
  std::optional<std::uint64_t> path;  // explain this record alone, whatever its pixel
  // The most pairs of a path of the pixel and a source in its ball. A pair takes 32 bytes of
  // memory, and a few times that as JSON.
  std::int64_t most_pairs = std::int64_t{1} << 25;
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress;  // paths
};

enum class PathFate : std::uint8_t {
  averaged,    // averaged over the sources in its ball that pass the weights
  orphan,      // no source in its ball passed: averaged over the nearest instead
  no_vertex,   // contributes u_i alone
  left_out,    // a value in use is not finite, or its block has no source: not in the pixel
  overflowed,  // its radiance, filtered or not, is not finite: not in the pixel
};

// [fit] of a path.
struct ExplainedFit {
  double ridge = 0;       // lambda_i
  Colour mean{0, 0, 0};   // in place of the fit, without what fireflies give
  Colour taken{1, 1, 1};  // how far from the mean to the fit; below 1 where it is held at 0
};

// One of the pixel's paths.
struct ExplainedPath {
  std::uint32_t vertex = 0;  // place of x_i in ExplainResult::vertices
  PathFate fate = PathFate::averaged;
  bool is_input = false;  // the path is in the picture without filter
  float radius = 0;       // r_i, world units; for `adaptive` the radius that it chose
  Rgb c_bar{0, 0, 0};
  Rgb given{0, 0, 0};               // what of c_bar fireflies have given
  std::optional<ExplainedFit> fit;  // not set: the rest of c_bar is the mean over its sources
  std::uint32_t neighbors = 0;      // number of sources averaged; 0 for an orphan
  double scale = 1;                 // factor of the sum over sources: 1 / number or 1 / (pi r_i^2)
  std::size_t begin = 0, end = 0;   // its pairs are [begin, end) of ExplainResult::pairs
  std::uint32_t in_ball = 0;        // number of pairs with chi = 1, with itself included
};

// A path i and a source j that is in its ball, that it adopted, or that gives to it as a firefly. A
// path that is a source is paired with itself too.
struct ExplainedPair {
  std::uint32_t path = 0, vertex = 0;  // places in ExplainResult::paths, ::vertices
  float distance = 0;                  // from x_i to x_j, world units
  // Bit k: term k of filter::kTermNames, and filter::KindWeights::kApart; 0 for the path itself.
  std::uint32_t refusers = 0;
  float area = 1;    // A_j of [disk], 1 for [average]
  float beside = 0;  // [fit]: weight beside that of the mean, before `taken`
  float given = 0;   // [fireflies]: (1 - p_j) / N_j, of what j brings; 0: it gives nothing to i
  bool in_ball = false, averaged = false, self = false;
};

// A firefly j among the vertices.
struct ExplainedFirefly {
  std::uint32_t vertex = 0;   // place in ExplainResult::vertices
  float luminance = 0;        // Y_j
  double ordinary = 0;        // m_j
  float kept = 1;             // p_j
  float reach = 0;            // R_j, world units; 0 where nothing is given
  std::uint64_t sources = 0;  // N_j; 0 where nothing is given
};

// Whether a vertex of the explanation is in a volume.
[[nodiscard]] inline bool in_volume(const run::BlockRecords& vertices, std::uint32_t i) {
  return !vertices.kind.empty() && vertices.kind[i] == filter::kVolume;
}

struct ExplainResult {
  ExplainRequest request;
  std::vector<std::uint32_t> widths;  // width of each camera's picture
  std::uint64_t passes = 0;           // number of selected passes
  std::uint64_t blocks = 0;           // number of blocks that hold a path of the pixel
  // Every record that occurs in a path or a pair, once, in the order of the dump, with every
  // channel of the file that a term can compare.
  run::BlockRecords vertices;
  std::vector<std::uint64_t> record;  // number of each vertex in the dump
  std::vector<std::uint32_t> pass;
  std::vector<bool> is_source;
  // The value averaged: c_j, c_j / rho_j, or the result of the previous iteration; of fireflies what
  // they keep of it.
  std::vector<Rgb> value;
  std::vector<ExplainedFirefly> fireflies;  // by vertex
  std::vector<ExplainedPath> paths;         // in the order of the dump
  std::vector<ExplainedPair> pairs;         // by path, then by record
};

// Throws Error{usage} for parameters that do not go together, for a camera, pixel, path or passes
// that the dump does not have, and for estimators that average over no ball: what explain() throws
// before it reads records.
void check(const run::Dump& dump, const ExplainRequest& request);

// Explains what psf filter does with the same parameters; of several iterations it explains the
// last. Reads the pixel numbers of all selected paths, and the whole blocks that hold a path of
// this pixel. Throws Error{bad_input} where no path falls into the pixel, Error{limit} above
// `most_pairs`, Error{interrupted}, and what check() and filter_dump() throw.
[[nodiscard]] ExplainResult explain(const run::Dump& dump, const ExplainRequest& request);

}  // namespace psf::explain
