#include "cli.h"

#include <fmt/format.h>
#include <malloc.h>

#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "core/interrupt.h"
#include "formats/error.h"

namespace psf::tools {
namespace {

int fail(const std::string& program, const std::string& message, ErrorCode code) {
  fmt::print(stderr, "{}: {}\n", program, message);
  return static_cast<int>(code);
}

// The innermost subcommand that was parsed: its name is what the user must ask for help.
const CLI::App* selected(const CLI::App* app) {
  while (!app->get_subcommands().empty()) app = app->get_subcommands().front();
  return app;
}

std::string full_name(const CLI::App* app) {
  const CLI::App* parent = app->get_parent();
  return parent == nullptr ? app->get_name() : full_name(parent) + " " + app->get_name();
}

// CLI11 lists what is left over backwards, and does not say what it took for a missing verb.
std::string explain(const CLI::App& command, const CLI::ParseError& error) {
  const std::vector<std::string> rest = command.remaining();
  if (rest.empty()) return error.what();
  if (command.get_require_subcommand_min() > 0) return "there is no verb " + rest.front();
  return (rest.front().starts_with("-") ? "unknown option " : "unexpected argument ") +
         rest.front();
}

}  // namespace

void add_common(CLI::App& command, CommonOptions& options, bool with_json) {
  command.add_option("--threads", options.threads, "threads to use; 0: all cores")
      ->capture_default_str();
  command.add_flag("--quiet", options.quiet, "no progress and no notes on stderr");
  if (with_json) {
    command.add_option("--json", options.json, "write the figures to this file, for programs")
        ->type_name("FILE");
  }
}

void set_example(CLI::App& command, const std::string& example) {
  command.footer("\nExample:\n  " + example);
}

void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kLargestKept = 16 << 20, kMostKept = 256 << 20;  // bytes; larger arrays go back
  mallopt(M_MMAP_THRESHOLD, kLargestKept);
  mallopt(M_TRIM_THRESHOLD, kMostKept);
#endif
}

int run_tool(CLI::App& app, int argc, char** argv) {
  core::watch_interrupts();
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::Success& success) {  // --help, --version
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    const CLI::App* command = selected(&app);
    const std::string name = full_name(command);
    return fail(name, fmt::format("{}; see {} --help", explain(*command, error), name),
                ErrorCode::usage);
  } catch (const Error& error) {
    return fail(app.get_name(), error.what(), error.code());
  } catch (const std::bad_alloc&) {
    return fail(app.get_name(), "out of memory; use a smaller block or picture", ErrorCode::limit);
  } catch (const std::exception& error) {
    return fail(app.get_name(), error.what(), ErrorCode::io);
  }
}

}  // namespace psf::tools
