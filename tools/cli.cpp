#include "cli.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <set>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/standard_streams.h"
#include "option_values.h"

namespace psf::tools {
namespace {

// How a run ended: without a message, well.
struct Ending {
  ErrorCode code{};
  std::string program, message;
};

// The long options of the program and all its verbs.
std::set<std::string>& option_names() {
  static std::set<std::string> names;
  return names;
}
void note_options(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    option_names().insert(option->get_lnames().begin(), option->get_lnames().end());
  }
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    note_options(*verb);
  }
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

// Parses and works.
Ending run(CLI::App& app, int argc, char** argv) {
  const std::string program = app.get_name();
  note_options(app);
  try {
    app.parse(argc, argv);
    return {};
  } catch (const CLI::Success& success) {  // --help, --version
    static_cast<void>(app.exit(success));
    return {};
  } catch (const CLI::ParseError& error) {
    const CLI::App* command = selected(&app);
    const std::string name = full_name(command);
    return {ErrorCode::usage, name,
            fmt::format("{}; see {} --help", explain(*command, error), name)};
  } catch (const Error& error) {
    return {error.code(), program, as_options(error.what())};
  } catch (const std::bad_alloc&) {
    return {ErrorCode::limit, program, "out of memory; use a smaller block or picture"};
  } catch (const std::filesystem::filesystem_error& error) {
    return {ErrorCode::io, program,
            fmt::format("{}: {}; check the folder's permissions, or choose another",
                        error.path1().string(), error.code().message())};
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return {};  // {fmt} throws where it cannot print: see run_tool()
    return {ErrorCode::io, program, error.what()};
  }
}

}  // namespace

void add_common(CLI::App& command, CommonOptions& options, bool with_json) {
  constexpr std::size_t kMostThreads = 4096;
  add_number(command, "--threads", options.threads, std::size_t{0}, kMostThreads,
             "threads to use; 0: all cores");
  command.add_flag("--quiet", options.quiet, "no progress and no notes on stderr");
  if (with_json) {
    command.add_option("--json", options.json, "write the figures to this file, for programs")
        ->type_name("FILE");
  }
}

std::string as_options(const std::string& message) {
  std::string text;
  for (std::size_t at = 0; at < message.size();) {
    const std::size_t begin = std::min(message.find('`', at), message.size());
    const std::size_t end = message.find('`', begin + 1);
    text += message.substr(at, begin - at);
    if (end == std::string::npos) return text + message.substr(begin);
    const std::string quoted = message.substr(begin + 1, end - begin - 1);
    const bool is_option = option_names().contains(quoted.substr(0, quoted.find_first_of(" =")));
    if (is_option) {
      text += "--" + quoted;
    } else {
      text += "`" + quoted;
    }
    at = is_option ? end + 1 : end;  // what closes one pair may open another
  }
  return text;
}

void set_example(CLI::App& command, const std::string& example) {
  command.footer("\nExample:\n  " + example);
}

void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kLargestKept = 32 << 20, kMostKept = 256 << 20;  // bytes; larger arrays go back
  mallopt(M_MMAP_THRESHOLD, kLargestKept);
  mallopt(M_TRIM_THRESHOLD, kMostKept);
#endif
}

int run_tool(CLI::App& app, int argc, char** argv) {
  core::open_standard_streams();
  core::watch_interrupts();
  Ending ending = run(app, argc, argv);
  // The comparison failed, but of what it found some is lost.
  if (ending.message.empty() || ending.code == ErrorCode::comparison) {
    try {
      core::flush_standard_output();
    } catch (const Error& error) {
      ending = {error.code(), app.get_name(), error.what()};
    }
  }
  if (ending.message.empty()) return 0;
  core::say(ending.program + ": " + ending.message);
  return static_cast<int>(ending.code);
}

}  // namespace psf::tools
