// Completion for fish: a command of fish's own for each option.
#include <fmt/format.h>

#include "manual/shell_text.h"
#include "manual/writers.h"

namespace psf::manual {
namespace {

std::string fish_quoted(const std::string& text) {
  return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
}

// What is offered for a value; files of other endings come after those that are wanted.
std::string fish_offer(const Value& value) {
  if (!value.words.empty()) return " -a " + fish_quoted(joined(value.words, " "));
  if (value.folder && !value.file) return " -a '(__fish_complete_directories)'";
  if (value.extensions.empty()) return "";
  std::string endings;
  for (const std::string& ending : value.extensions) endings += " ." + ending;
  return " -k -a '(for ending in" + endings + "; __fish_complete_suffix $ending; end)'";
}

void add_lines(const Command& command, const std::string& begin, std::string& text) {
  for (const Option& option : command.options) {
    text += begin;
    for (const std::string& name : option.names) {
      text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    }
    // Of any file: it takes a value, and fish offers files; else it offers what it is told alone.
    const bool any_file = option.value.file && option.value.extensions.empty();
    if (!option.flag) text += (any_file ? " -r -F" : " -x") + fish_offer(option.value);
    text += " -d " + fish_quoted(brief(option.help)) + "\n";
  }
  if (command.arguments.empty()) return;
  text += begin + fish_offer(command.arguments[0].value) + "\n";  // those of a command are alike
}

}  // namespace

std::string fish_completion(const Command& program) {
  const std::string complete = "complete -c " + program.name;
  std::string text = note(program) + complete + " -f\n";
  const std::string begin = complete + " -n ";
  add_lines(program, program.verbs.empty() ? complete : begin + "__fish_use_subcommand", text);
  for (const Command& verb : program.verbs) {
    text += fmt::format("{}__fish_use_subcommand -a {} -d {}\n", begin, verb.name,
                        fish_quoted(brief(verb.summary)));
  }
  for (const Command& verb : program.verbs) {
    add_lines(verb, begin + fish_quoted("__fish_seen_subcommand_from " + verb.name), text);
  }
  return text;
}

}  // namespace psf::manual
