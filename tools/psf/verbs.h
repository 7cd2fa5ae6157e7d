// The command line of psf. Each function but the first adds a verb, which has a file of its name.
#pragma once

#include <CLI/CLI.hpp>

namespace psf::tools {

void declare_psf(CLI::App& app);  // all of it

void add_ablate(CLI::App& app);
void add_cat(CLI::App& app);
void add_compare(CLI::App& app);
void add_flicker(CLI::App& app);
void add_converge(CLI::App& app);
void add_explain(CLI::App& app);
void add_export(CLI::App& app);
void add_filter(CLI::App& app);
void add_info(CLI::App& app);
void add_recover(CLI::App& app);
void add_relight(CLI::App& app);
void add_report(CLI::App& app);
void add_sweep(CLI::App& app);
void add_tune(CLI::App& app);
void add_verify(CLI::App& app);

}  // namespace psf::tools
