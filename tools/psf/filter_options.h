// The command line of psf filter, and the part of it about how to filter, which other verbs share.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli.h"
#include "filter/parameters/text.h"
#include "run/dump.h"
#include "run/filter_dump.h"
#include "run/pictures.h"
#include "run/window.h"

namespace psf::tools {

struct FilterOptions : filter::ParameterTexts {
  CommonOptions common;
  std::string input;
  std::string vertex;  // rule as written; empty: the vertex of the file
  std::vector<std::string> outputs;
  std::string passes, snapshots;  // as written; empty: all passes, no snapshots
  std::optional<std::uint32_t> frame;
  run::WindowTexts window;
  std::string layers = "all";  // layers of EXRs, as written
  std::string tuned;           // file of psf tune that gives the parameters; empty: none
  bool refusals = false, follow = false;
  std::optional<std::uint64_t> max_memory;  // bytes
};

// Switches off, in all sets, the terms that are not `asked` for and whose channel the dump lacks.
// Adds a remark about them to `notes`, to be printed when everything is checked, since an error
// must be the only line.
void fit_terms(const run::Dump& dump, std::span<filter::Parameters> sets, filter::TermSet asked,
               std::vector<std::string>& notes);
// The layers that `text` names: a list, "all" or "none"; any name may be of a layer of the light.
[[nodiscard]] run::PictureLayers layers_of(const std::string& text);
// Throws Error{usage} for a name that is none and for `fireflies` where none are spread, and
// Error{bad_input} for a layer of which the dump lacks the channel.
void check_layers(const run::Dump& dump, const std::string& text, const run::FilterRequest& run);

// Each of these declares options, which write into `options`.
void add_parameter_options(CLI::App& command, filter::ParameterTexts& options);
void add_filter_options(CLI::App& command, FilterOptions& options);

// The snapshots of a run over `passes` passes, ascending.
[[nodiscard]] std::vector<std::uint64_t> snapshots_of(const std::string& text,
                                                      std::uint64_t passes);

}  // namespace psf::tools
