// The command line of psf-bench. Each function but the first adds a verb, which has a file of its
// name.
#pragma once

#include <CLI/CLI.hpp>

namespace psf::bench {

void declare_psf_bench(CLI::App& app);  // all of it

void add_files(CLI::App& app);
void add_filter(CLI::App& app);
void add_sweep(CLI::App& app);
void add_render(CLI::App& app);  // only where the renderer is built

}  // namespace psf::bench
