// Man pages, in the macros of man(7).
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <regex>
#include <utility>
#include <vector>

#include "core/error.h"
#include "manual/writers.h"
#include "version.h"

namespace psf::manual {
namespace {

// Text as roff sets it: what roff would take for its own is escaped, and a minus is no hyphen.
std::string escaped(const std::string& text) {
  std::string result;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const bool within = k > 0 && std::isalnum(static_cast<unsigned char>(text[k - 1])) != 0;
    switch (text[k]) {
      case '\\':
        result += "\\(rs";
        break;
      case '^':
        result += "\\(ha";
        break;
      case '~':
        result += "\\(ti";
        break;
      case '`':
        result += "\\(ga";
        break;
      case '\'':
        result += "\\(aq";
        break;
      case '-':
        result += within ? "-" : "\\-";
        break;
      case '.':
        result += k == 0 ? "\\&." : ".";
        break;
      default:
        result += text[k];
    }
  }
  return result;
}

// As escaped(), where every hyphen can be copied into a shell.
std::string typed(const std::string& text) {
  return std::regex_replace(escaped(text), std::regex("(^|[^\\\\])-"), "$1\\-");
}

// In one piece: "\%" keeps what follows from being hyphenated.
std::string bold(const std::string& text) {
  return "\\fB\\%" + typed(text) + "\\fR";
}
std::string italic(const std::string& text) {
  return "\\fI\\%" + typed(text) + "\\fR";
}

// The words of help and prose, with names of options and pages in bold, of files in italics.
std::string set_text(const std::string& text) {
  static const std::regex name("(--[a-z0-9-]*[a-z0-9])|(psf[a-z-]*)\\(1\\)|([a-z_]+/README\\.md)");
  std::string result;
  auto rest = text.begin();
  for (std::sregex_iterator at(text.begin(), text.end(), name), end; at != end; ++at) {
    result += escaped(std::string(rest, text.begin() + at->position()));
    if ((*at)[1].matched) result += bold((*at)[1]);
    if ((*at)[2].matched) result += bold((*at)[2]) + "(1)";
    if ((*at)[3].matched) result += italic((*at)[3]);
    rest = text.begin() + at->position() + at->length();
  }
  return result + escaped(std::string(rest, text.end()));
}

std::string sentence(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text.ends_with('.') ? text : text + '.';
}
std::string phrase(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  text = text.substr(0, text.find("; "));
  if (text.ends_with('.')) text.pop_back();
  return text;
}

// "-o, --output FILE"
std::string names_of(const Option& option) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "" : ", ") + bold(name);
  return option.flag ? names : names + " " + italic(option.value.name);
}

// An exclusion is told by the option that has more of them: not by each of the twenty that a file
// of parameters excludes.
bool tells_exclusions(const Command& command, const Option& option) {
  for (const Option& other : command.options) {
    for (const std::string& name : option.excludes) {
      if (name == other.names.back() && other.excludes.size() > option.excludes.size())
        return false;
    }
  }
  return !option.excludes.empty();
}

// Help texts are phrases, and begin with whatever they explain: they stay as they are.
std::string entry(const Command& command, const Option& option, const std::string& title) {
  std::string text = set_text(option.help);
  if (!option.standard.empty()) text += " (default " + escaped(option.standard) + ")";
  if (option.required) text += "; required";
  if (tells_exclusions(command, option)) {
    std::string names;
    for (const std::string& name : option.excludes) {
      names += (names.empty() ? "" : ", ") + set_text(name);
    }
    text += "; not together with " + names;
  }
  return fmt::format(".TP\n{}\n{}\n", title, text);
}

std::string synopsis(const Command& program, const Command& command) {
  const std::string name = &program == &command ? program.name : program.name + " " + command.name;
  if (!command.verbs.empty()) {
    return fmt::format("{0} {1} [{2}]... [{3}]...\n.br\n{0} {4} | {5}\n", bold(name),
                       italic("VERB"), italic("OPTION"), italic("ARGUMENT"), bold("--help"),
                       bold("--version"));
  }
  std::string text = bold(name);
  for (const Option& option : command.options) {
    if (!option.required) continue;
    text += " " + bold(option.names.front()) + " " + italic(option.value.name);
  }
  text += " [" + italic("OPTION") + "]...";
  for (const Option& argument : command.arguments) {
    const std::string one = italic(argument.names[0]) + (argument.repeats ? "..." : "");
    text += " " + (argument.required ? one : "[" + one + "]");
  }
  return text + "\n";
}

// The options, those of a group below its name.
std::string options(const Command& command) {
  std::vector<std::string> groups;
  for (const Option& option : command.options) {
    if (std::find(groups.begin(), groups.end(), option.group) == groups.end()) {
      groups.push_back(option.group);
    }
  }
  std::string text = ".SH OPTIONS\n";
  for (const std::string& group : groups) {
    if (group != "Options") text += ".SS " + escaped(group) + "\n";
    for (const Option& option : command.options) {
      if (option.group == group) text += entry(command, option, names_of(option));
    }
  }
  return text;
}

std::string exit_status() {
  const std::pair<int, const char*> codes[] = {
      {0, "Done."},
      {static_cast<int>(ErrorCode::comparison),
       "A comparison, a verification or a check of slopes failed; a file was saved with losses."},
      {static_cast<int>(ErrorCode::usage), "The command line is wrong."},
      {static_cast<int>(ErrorCode::bad_input),
       "A scene or a file is malformed, damaged or lacks something."},
      {static_cast<int>(ErrorCode::io),
       "Input or output: a missing file, a full disk, no permission, standard output that takes no "
       "more."},
      {static_cast<int>(ErrorCode::limit), "A limit: memory, threads, size."},
      {static_cast<int>(ErrorCode::interrupted),
       "Interrupted; what is written is whole up to there, or not there."}};
  std::string text = ".SH EXIT STATUS\n";
  for (const auto& [code, meaning] : codes) text += fmt::format(".TP\n.B {}\n{}\n", code, meaning);
  return text;
}

// The kinds of files that the command names.
std::string files(const Command& command) {
  const std::pair<const char*, const char*> kinds[] = {
      {"pvb",
       "Path-vertex buffer: the records of a render, a record each light transport path. Its "
       "format is specified byte by byte in the file formats/README.md of the source."},
      {"exr", "OpenEXR picture: linear values, layers, the parameters as attributes."},
      {"png", "Picture to look at: tone-mapped, sRGB."},
      {"json",
       "Scene, or figures for programs; the format of scenes is described in the file "
       "sample_data/README.md of the source."}};
  std::vector<const Command*> all = {&command};
  for (const Command& verb : command.verbs) all.push_back(&verb);
  std::string text;
  for (const auto& [kind, meaning] : kinds) {
    const std::regex name("\\." + std::string(kind) + "\\b");
    bool named = false;
    for (const Command* one : all) {
      named = named || std::regex_search(one->example, name);
      for (const auto* list : {&one->options, &one->arguments}) {
        for (const Option& option : *list) {
          named = named || std::regex_search(option.value.name + " " + option.help, name);
        }
      }
    }
    if (named) text += fmt::format(".TP\n.I *.{}\n{}\n", kind, set_text(meaning));
  }
  return text.empty() ? text : ".SH FILES\n" + text;
}

std::string see_also(const std::vector<Command>& programs, const Command& program,
                     const Command& command) {
  std::vector<std::string> pages;
  const auto add = [&](const std::string& name) {
    if (name != page_name(program, command)) pages.push_back(bold(name) + "(1)");
  };
  for (const Command& other : programs) {
    if (other.name != program.name) add(other.name);
  }
  add(program.name);
  for (const Command& verb : program.verbs) add(page_name(program, verb));
  std::string text = ".SH SEE ALSO\n";
  for (const std::string& page : pages) text += (&page == &pages[0] ? "" : ",\n") + page;
  return text + "\n";
}

}  // namespace

std::string page_name(const Command& program, const Command& command) {
  return &program == &command ? program.name : program.name + "-" + command.name;
}

std::string man_page(const std::vector<Command>& programs, const Command& program,
                     const Command& command) {
  const std::string name = page_name(program, command);
  std::string upper = name;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string page =
      fmt::format(".TH {} 1 \"\" \"psf {}\" \"psf manual\"\n", typed(upper), tools::kVersion);
  page += ".nh\n.ad l\n";  // neither hyphens nor gaps
  page += fmt::format(".SH NAME\n{} \\- {}\n", typed(name), escaped(phrase(command.summary)));
  page += ".SH SYNOPSIS\n" + synopsis(program, command);
  page += ".SH DESCRIPTION\n" + set_text(sentence(command.summary)) + "\n";
  std::string paragraph = prose(name);
  if (!paragraph.empty())
    page += ".PP\n" + std::regex_replace(set_text(paragraph), std::regex("\n"), "\n.PP\n") + "\n";
  if (!command.verbs.empty()) page += ".SH VERBS\n";
  for (const Command& verb : command.verbs) {
    page += fmt::format(".TP\n{}(1)\n{}\n", bold(page_name(program, verb)),
                        set_text(sentence(verb.summary)));
  }
  if (!command.arguments.empty()) page += ".SH ARGUMENTS\n";
  for (const Option& argument : command.arguments) {
    const std::string type =
        argument.value.name.empty() ? "" : " (" + italic(argument.value.name) + ")";
    page += entry(command, argument, italic(argument.names[0]) + type);
  }
  page += options(command);
  if (!command.example.empty()) page += ".SH EXAMPLE\n.EX\n" + typed(command.example) + "\n.EE\n";
  return page + exit_status() + files(command) + see_also(programs, program, command);
}

}  // namespace psf::manual
