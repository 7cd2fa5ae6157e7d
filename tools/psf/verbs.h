// The verbs of psf. Each function adds a subcommand; each verb has a file.
#pragma once

#include <CLI/CLI.hpp>

namespace psf::tools {

void add_cat(CLI::App& app);
void add_compare(CLI::App& app);
void add_converge(CLI::App& app);
void add_explain(CLI::App& app);
void add_export(CLI::App& app);
void add_filter(CLI::App& app);
void add_info(CLI::App& app);
void add_recover(CLI::App& app);
void add_report(CLI::App& app);
void add_sweep(CLI::App& app);
void add_tune(CLI::App& app);
void add_verify(CLI::App& app);

}  // namespace psf::tools
