// Completion for zsh, in the words of its function _arguments.
#include <fmt/format.h>

#include "manual/shell_text.h"
#include "manual/writers.h"

namespace psf::manual {
namespace {

// Within single quotes.
std::string zsh_quoted(const std::string& text) {
  return "'" + replaced(text, "'", "'\\''") + "'";
}

// Text between brackets or colons.
std::string described(const std::string& text) {
  std::string result = replaced(text, "\\", "\\\\");
  for (const char* mark : {":", "[", "]"})
    result = replaced(result, mark, std::string("\\") + mark);
  return result;
}

// ":FILE.pvb:_files -g '*.pvb'": a value's name, and what is offered for it.
std::string zsh_offer(const Value& value) {
  std::string action = " ";  // nothing
  if (!value.words.empty()) {
    action = "(" + joined(value.words, " ") + ")";
  } else if (value.file && value.extensions.empty()) {
    action = "_files";
  } else if (value.file) {
    // "(-.)": plain files, also by a link. Without it the brackets before would be taken for such.
    action = fmt::format("_files -g \"*.({})(-.)\"", joined(value.extensions, "|"));
  } else if (value.folder) {
    action = "_files -/";
  }
  return ":" + described(value.name) + ":" + action;
}

// The specification of an option: '(--tuned)--r0=[radius]:R: '.
std::string specification(const Option& option) {
  std::vector<std::string> excluded = option.excludes;
  if (!option.repeats) excluded.insert(excluded.end(), option.names.begin(), option.names.end());
  std::string names;  // {-o+,--output=}
  for (const std::string& name : option.names) {
    const bool is_long = name.starts_with("--");
    names += (names.empty() ? "" : ",") + name + (option.flag ? "" : is_long ? "=" : "+");
  }
  const std::string before =
      (excluded.empty() ? "" : "(" + joined(excluded, " ") + ")") + (option.repeats ? "*" : "");
  const std::string after =
      "[" + described(brief(option.help)) + "]" + (option.flag ? "" : zsh_offer(option.value));
  if (option.names.size() == 1) return zsh_quoted(before + names + after);
  return zsh_quoted(before) + "{" + names + "}" + zsh_quoted(after);
}

// The lines after _arguments.
std::string specifications(const Command& command, const std::string& margin) {
  std::vector<std::string> lines;
  for (const Option& option : command.options) lines.push_back(specification(option));
  for (const Option& argument : command.arguments) {
    std::string spec = zsh_offer(argument.value);
    spec = argument.repeats ? "*" + spec : (argument.required ? ":" : "::") + spec.substr(1);
    lines.push_back(zsh_quoted(spec));
  }
  return margin + joined(lines, " \\\n" + margin);
}

}  // namespace

std::string zsh_completion(const Command& program) {
  const std::string function = "_" + identifier(program.name);
  std::string text =
      fmt::format("#compdef {}\n{}\n{}() {{\n", program.name, note(program), function);
  if (program.verbs.empty()) {
    text += "  _arguments \\\n" + specifications(program, "    ") + "\n}\n";
  } else {
    std::string verbs, cases;
    for (const Command& verb : program.verbs) {
      verbs += "    " + zsh_quoted(described(verb.name) + ":" + brief(verb.summary)) + "\n";
      cases += fmt::format("    argument:{})\n      _arguments \\\n{} ;;\n", verb.name,
                           specifications(verb, "        "));
    }
    text += "  local curcontext=$curcontext state line\n  typeset -A opt_args\n";
    text += "  local -a verbs=(\n" + verbs + "  )\n";
    text += "  _arguments -C \\\n" + specifications(program, "    ");
    text += " \\\n    '1:verb:->verb' '*::argument:->argument'\n";
    text += "  case $state:$line[1] in\n    verb:*) _describe verb verbs ;;\n";
    text += cases + "  esac\n}\n";
  }
  return text + fmt::format("\n{} \"$@\"\n", function);
}

}  // namespace psf::manual
