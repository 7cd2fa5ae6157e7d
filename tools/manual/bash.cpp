// Completion for bash: one function a program, which needs nothing but bash.
#include <fmt/format.h>

#include <map>

#include "manual/shell_text.h"
#include "manual/writers.h"

namespace psf::manual {
namespace {

// What fills COMPREPLY with the values of an option or an argument; nothing for free text.
std::string bash_offer(const Value& value) {
  if (!value.words.empty()) return fmt::format("_psf_words '{}'", joined(value.words, " "));
  if (value.file)
    return "_psf_files" + (value.extensions.empty() ? "" : " " + joined(value.extensions, " "));
  return value.folder ? "_psf_files /" : "";
}

// The lines of a command within the case statements, which tell commands by their names.
void add_cases(const Command& command, const std::string& verb, std::string& values,
               std::string& options, std::string& arguments) {
  std::vector<std::string> names;
  std::map<std::string, std::vector<std::string>> offers;  // options that offer the same are a line
  for (const Option& option : command.options) {
    names.insert(names.end(), option.names.begin(), option.names.end());
    if (option.flag) continue;
    auto& patterns = offers[bash_offer(option.value)];
    for (const std::string& name : option.names) patterns.push_back("'" + verb + " " + name + "'");
  }
  for (const auto& [offer, patterns] : offers) {
    values += fmt::format("    {}) {}return ;;\n", joined(patterns, " | "),
                          offer.empty() ? "" : offer + "; ");
  }
  options += fmt::format("      '{}') _psf_words '{}' ;;\n", verb, joined(names, " "));
  if (command.arguments.empty()) return;
  // Those of a command are alike.
  arguments += fmt::format("      '{}') {} ;;\n", verb, bash_offer(command.arguments[0].value));
}

constexpr const char* kHelpers = R"(
# Offers some words.
_psf_words() {
  COMPREPLY=($(compgen -W "$1" -- "$cur"))
}
# Offers folders, and files: those with these endings, all without one, none for /.
_psf_files() {
  local IFS=$'\n' ending
  compopt -o filenames
  COMPREPLY=($(compgen -d -- "$cur"))
  [[ $1 == / ]] && return
  for ending in ${1:+"$@"}; do COMPREPLY+=($(compgen -f -X "!*.$ending" -- "$cur")); done
  (($#)) || COMPREPLY=($(compgen -f -- "$cur"))
}
)";

constexpr const char* kBegin =
    R"(  local cur=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} verb= word
  COMPREPLY=()
  # "--name=value" is three words to bash.
  if [[ $cur == = ]]; then
    cur=
  elif [[ $before == = ]]; then
    before=${COMP_WORDS[COMP_CWORD - 2]}
  fi
)";

}  // namespace

std::string bash_completion(const Command& program) {
  std::string function = "_" + identifier(program.name);
  std::string values, options, arguments;
  add_cases(program, "", values, options, arguments);
  std::vector<std::string> verbs;
  for (const Command& verb : program.verbs) {
    verbs.push_back(verb.name);
    add_cases(verb, verb.name, values, options, arguments);
  }
  std::string text = note(program) + kHelpers + "\n" + function + "() {\n" + kBegin;
  if (!verbs.empty()) {
    text += R"(  for word in "${COMP_WORDS[@]:1:COMP_CWORD - 1}"; do
    [[ $word == -* ]] || { verb=$word; break; }
  done
)";
    arguments = fmt::format("      '') _psf_words '{}' ;;\n", joined(verbs, " ")) + arguments;
  }
  text += "  case \"$verb $before\" in\n" + values + "  esac\n";
  text += "  if [[ $cur == -* ]]; then\n    case $verb in\n" + options;
  text += "    esac\n  else\n    case $verb in\n" + arguments + "    esac\n  fi\n}\n";
  return text + fmt::format("complete -F {} {}\n", function, program.name);
}

}  // namespace psf::manual
