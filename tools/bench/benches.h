// The subcommands of psf-bench. One file each.
#pragma once

#include <CLI/CLI.hpp>

namespace psf::bench {

void add_files(CLI::App& app);
void add_filter(CLI::App& app);
void add_sweep(CLI::App& app);

}  // namespace psf::bench
