// Common options of all tools, and the place where errors become a line of text and an exit code.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>
#include <vector>

#include "core/apart.h"

namespace psf::tools {

struct CommonOptions {
  std::size_t threads = 0;  // 0: all cores
  bool quiet = false;
  std::string json;  // file for the figures as JSON; empty: none
};

// Checks the files of a verb before it works.
using core::check_files;

// Adds --threads, --quiet and, unless `with_json` is false, --json.
void add_common(CLI::App& command, CommonOptions& options, bool with_json = true);

// Parses the command line, runs the callbacks, which do the work and may throw, and returns the
// exit code of ErrorCode. It is also an error if printed text could not be written.
int run_tool(CLI::App& app, int argc, char** argv);

// Makes the allocator keep freed memory, so that the next block of a filter run gets the memory of
// the one before. Memory from the system would have to be cleared, which takes a tenth of the time
// for blocks of 65,536 records. It holds for the whole process.
void keep_freed_memory();

// The text of a message with its parameters as options: the library writes "`r0 8px`", a user of
// this program gives "--r0 8px". Other words in backquotes stay as they are.
[[nodiscard]] std::string as_options(const std::string& message);

// Sets the example at the end of a command's --help, in a paragraph of its own.
void set_example(CLI::App& command, const std::string& example);

}  // namespace psf::tools
