// What all tools share: common options, and one place where errors become one line and an exit
// code.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>
#include <vector>

namespace psf::tools {

struct CommonOptions {
  std::size_t threads = 0;  // 0: all cores
  bool quiet = false;
  std::string json;  // figures for programs go here; empty: nowhere
};

// What every verb does before it works: throws Error{usage} where an output is an input or another
// output (core/apart.h), Error{io} where one cannot be written. Empty names are none.
void check_files(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);

// --threads, --quiet, --json. A verb without figures leaves json out.
void add_common(CLI::App& command, CommonOptions& options, bool with_json = true);

// Parses, runs the callbacks, returns the exit code of ErrorCode. `command` callbacks do the work
// and throw. Where what was printed does not get out that is an error, too.
int run_tool(CLI::App& app, int argc, char** argv);

// What a block of a filter gives back the next one takes: without going through the system, which
// would clear it anew (a tenth of the time for blocks of 65,536 records). For the whole process.
void keep_freed_memory();

// The example that closes every --help, set in its own paragraph.
void set_example(CLI::App& command, const std::string& example);

}  // namespace psf::tools
