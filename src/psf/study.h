// Studies of the filter's parameters: sweeps, convergence, and tuning without a reference. What is
// estimated how stands in src/study/README.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "psf/error.h"
#include "psf/export.h"
#include "psf/parameters.h"
#include "psf/passes.h"
#include "psf/picture.h"

namespace psf {

// Name and text of every parameter.
using ParameterTexts = std::vector<std::pair<std::string, std::string>>;

// A row of Dump::sweep(): a set of parameters, and how far its picture is from the reference.
struct SweepRow {
  ParameterTexts parameters;                           // of the row
  std::vector<std::pair<std::string, double>> errors;  // by metric
  double neighbors = 0;                                // mean over the queries
  double seconds = 0;                                  // of the traversal it shared
};

// What Dump::sweep() measured.
struct SweepResult {
  std::vector<SweepRow> rows;      // in the order of the sets
  std::vector<std::string> notes;  // what was switched off, and why
};

// The radii that psf tune tries unless others are asked for, as a list for
// Parameters::combinations().
[[nodiscard]] PSF_API std::string tune_radii();

// How Dump::tune() compares sets of parameters.
struct TuneOptions {
  Passes passes;                            // the passes that are filtered
  std::size_t camera = 0;                   // the picture's
  double epsilon = 1e-2;                    // of the relative error: guards dark places
  std::optional<std::uint64_t> max_memory;  // bytes; where they do not suffice: Error{limit}
  // As --vertex of the commands: "first-rough", "depth:K", "roughness:T", "distance:D"; empty: the
  // vertex of the file.
  std::string vertex = {};
  // Called now and then by the thread that tunes, with numbers of paths.
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress = {};
};

// One set of parameters, and estimates of relMSE and its parts for the picture of all passes.
struct TuneRow {
  ParameterTexts parameters;      // of the row
  double error = 0;               // relMSE, estimated
  double standard_error = 0;      // of `error`
  double bias_sq = 0;             // the part of `error` that is bias, squared
  double variance = 0;            // the part that is noise
  double neighbors = 0;           // mean over the queries
  double sigmas_above_least = 0;  // standard errors between this error and the least
  bool may_be_better = false;     // its error may be clearly less than that of the choice
};

// What Dump::tune() found.
struct TuneResult {
  std::vector<TuneRow> rows;        // least error first
  Parameters best;                  // the choice, for Dump::filter(): what psf filter --tuned takes
  bool sure = false;                // no other set may be clearly better
  double unfiltered = 0;            // relMSE of the picture without filter
  std::vector<std::string> notes;   // what was switched off, and why
  std::string json;                 // the bytes of psf tune --json
  std::vector<std::string> inputs;  // the files that it was made of

  // Writes `json` to a file, whole or not at all. Throws Error{usage} where that is one of
  // `inputs`, Error{io}.
  PSF_API void save(const std::string& path) const;
};

// How Dump::ablate() measures and shows.
struct AblateOptions {
  Passes passes;                            // the passes that are filtered
  std::size_t camera = 0;                   // the picture's
  std::optional<Picture> reference;         // what errors are against; not set: there are none
  std::string metric = "relMSE";            // of metric_names(); the error on the sheet
  double epsilon = 1e-2;                    // of the relative metrics
  float exposure = 0;                       // of the sheet, SSIM and FLIP: stops
  std::array<std::size_t, 4> crop = {};     // x, y, width, height on the sheet; all 0: everything
  std::size_t columns = 5;                  // pictures beside each other on the sheet
  std::optional<std::uint64_t> max_memory;  // bytes; where they do not suffice: Error{limit}
  // As --vertex of the commands: "first-rough", "depth:K", "roughness:T", "distance:D"; empty: the
  // vertex of the file.
  std::string vertex = {};
  // Called now and then by the thread that works, with numbers of paths.
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress = {};
};

// A picture of Dump::ablate().
struct AblationRow {
  std::string part;            // "weights", "blocks", "iterations"
  std::string label;           // "unfiltered", "+ normal 0.95", "2 blocks of 8 passes"
  ParameterTexts parameters;   // empty where nothing is filtered
  std::size_t first_pass = 0;  // of those it is made of
  std::size_t passes = 0;      // their number
  std::vector<std::pair<std::string, double>> errors;  // by metric; none without a reference
  double mean = 0;                                     // luminance of the picture
  double change = 0;     // of the mean, as a share of that of the same passes without filter
  double neighbors = 0;  // mean over the queries
  double seconds = 0;    // of the filter
  Picture picture;       // R, G and B
};

// What Dump::ablate() measured.
struct AblationResult {
  std::vector<AblationRow> rows;    // the parts one after the other
  std::vector<std::string> notes;   // what was switched off or left out, and why
  std::string json;                 // the bytes of psf ablate --json, but for times
  std::vector<unsigned char> png;   // the bytes of the sheet
  std::vector<std::string> inputs;  // the files that it was made of

  // Writes the sheet to a file, whole or not at all. Throws Error{usage} where that is one of
  // `inputs`, Error{io}.
  PSF_API void save(const std::string& path) const;
};

// How converge() measures.
struct ConvergeOptions {
  std::optional<std::uint64_t> passes;      // the first so many; not set: all of the first dump
  std::size_t camera = 0;                   // the picture's
  double epsilon = 1e-2;                    // of the relative metrics
  bool all_metrics = false;                 // SSIM and FLIP too: slower
  bool times = true;                        // run each set once more to take its time
  std::vector<std::string> render_json;     // texts that psf-render --json wrote, for speed-ups
  std::optional<std::uint64_t> max_memory;  // bytes; where they do not suffice: Error{limit}
  // As --vertex of the commands: "first-rough", "depth:K", "roughness:T", "distance:D"; empty: the
  // vertex of the file.
  std::string vertex = {};
  // Called now and then by the thread that works, with numbers of paths.
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress = {};
};

// One set of parameters after n passes.
struct ConvergeRow {
  std::string id;             // "unfiltered", "0001", ...
  ParameterTexts parameters;  // empty where nothing is filtered
  std::uint64_t n = 0;        // passes
  // The columns of converge.csv by name: "relMSE", "bias_sq", "variance_ci_low", "slope_variance",
  // "neighbors" and so on; NaN where there is none.
  std::vector<std::pair<std::string, double>> values;
};

// What converge() measured.
struct ConvergeResult {
  std::vector<ConvergeRow> rows;    // unfiltered first, then the sets in their order; n ascending
  std::vector<std::string> notes;   // what was switched off, and why
  std::string json;                 // the bytes of the file converge.json
  std::string csv;                  // the bytes of the file converge.csv
  std::vector<std::string> inputs;  // the files that it was made of

  // Writes converge.json and converge.csv into a folder, which is made where it is missing. Throws
  // Error{usage} where a study is there already or a file is one of `inputs`, Error{io}.
  PSF_API void save(const std::string& folder) const;
};

// What psf converge does, without its pictures: the errors of every set after 1, 2, 4, ... passes.
// `dumps`: files of one scene and with different seeds; from two on bias and variance are told
// apart, from three on there are intervals. Throws Error{usage}, Error{bad_input}, Error{limit},
// Error{interrupted}.
[[nodiscard]] PSF_API ConvergeResult converge(std::span<const std::string> dumps,
                                              const Picture& reference,
                                              std::span<const Parameters> sets,
                                              const ConvergeOptions& options = {});

}  // namespace psf
