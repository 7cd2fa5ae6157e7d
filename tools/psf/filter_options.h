// The command line of psf filter.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli.h"
#include "filter/parameters.h"
#include "filter/radius.h"

namespace psf::tools {

struct FilterOptions {
  CommonOptions common;
  std::string input;
  std::vector<std::string> outputs;
  // As written; empty: the default.
  std::string r0, block, normal, reflectance, hit_distance, plane, direction, sources, passes,
      snapshots;
  double delta = filter::Radius().delta;
  std::optional<bool> visibility;
  bool material = false, no_weights = false;
  bool demodulate = false, refusals = false, follow = false;
  std::optional<std::uint64_t> max_memory;  // bytes
  std::uint32_t iterations = 1;
  std::string search = "flann", estimator = "average", radius_count = "samples";
};

// Declares the options, which write into `options`.
void add_filter_options(CLI::App& command, FilterOptions& options);

// Throws Error{usage} naming the option whose text is no value of it.
[[nodiscard]] filter::Parameters parameters_of(const FilterOptions& options);
// Of a run over `passes` passes, ascending.
[[nodiscard]] std::vector<std::uint64_t> snapshots_of(const std::string& text,
                                                      std::uint64_t passes);

}  // namespace psf::tools
