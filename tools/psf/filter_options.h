// The command line of psf filter, and of other verbs the part of it that says how to filter.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli.h"
#include "filter/parameters.h"
#include "filter/radius.h"
#include "filter/weights.h"
#include "study/dump.h"
#include "study/pictures.h"

namespace psf::tools {

// Every parameter of the filter but what a run counts.
struct ParameterOptions {
  // As written; empty: the default.
  std::string r0, block, normal, reflectance, hit_distance, plane, direction, gloss, sources;
  double delta = filter::Radius().delta, agree = filter::Parameters().agree;
  std::optional<bool> visibility;
  bool material = false, no_weights = false;
  bool demodulate = false;
  std::uint32_t iterations = 1;
  std::string search = "flann", estimator = "average", radius_count = "samples";
};

struct FilterOptions : ParameterOptions {
  CommonOptions common;
  std::string input;
  std::vector<std::string> outputs;
  std::string passes, snapshots;  // as written; empty: all, none
  std::string layers = "all";     // of EXRs, as written
  std::string tuned;              // a file of psf tune that the parameters come from; empty: none
  bool refusals = false, follow = false;
  std::optional<std::uint64_t> max_memory;  // bytes
};

// The terms that the command line gives; those that it leaves at their default are not among them.
[[nodiscard]] filter::TermSet asked_terms(const CLI::App& command);
// Switches off, in all sets, what the dump cannot serve and nobody asked for; what is to be said of
// it is added to `notes`, for when all else was checked: an error is one line.
void fit_terms(const study::Dump& dump, std::span<filter::Parameters> sets, filter::TermSet asked,
               std::vector<std::string>& notes);
// The layers that a list, "all" or "none" names. Throws Error{usage} for an unknown name.
[[nodiscard]] study::PictureLayers layers_of(const std::string& text);

// Each declares its options, which write into `options`.
void add_parameter_options(CLI::App& command, ParameterOptions& options);
void add_filter_options(CLI::App& command, FilterOptions& options);

// Each throws Error{usage} naming the option whose text is no value of it.
[[nodiscard]] filter::Parameters parameters_of(const ParameterOptions& options);
[[nodiscard]] filter::Parameters parameters_of(const FilterOptions& options);
// Of a run over `passes` passes, ascending.
[[nodiscard]] std::vector<std::uint64_t> snapshots_of(const std::string& text,
                                                      std::uint64_t passes);

}  // namespace psf::tools
