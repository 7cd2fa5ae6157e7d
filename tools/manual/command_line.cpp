#include "manual/command_line.h"

#include <algorithm>
#include <regex>
#include <set>

#include "core/text.h"

namespace psf::manual {
namespace {

// On one line, as it was before it was wrapped for the terminal.
std::string on_one_line(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

// What checks the option's text, which CLI11 adds to the name of its type; empty: nothing.
std::string check_of(const CLI::Option& option) {
  try {
    // It has no const way to ask; nothing is changed.
    return const_cast<CLI::Option&>(option).get_validator()->get_description();
  } catch (const CLI::OptionNotFound&) {
    return "";
  }
}

Value value_of(const CLI::Option& option) {
  std::string type = option.get_type_name();
  const std::string check = check_of(option);
  if (!check.empty()) type.resize(type.size() - check.size() - 1);
  if (check.starts_with("{")) return parse_value(check);
  Value value = parse_value(type);
  const std::size_t range = check.find(" in [");
  if (range != std::string::npos) value.name += check.substr(range);
  return value;
}

Option option_of(const CLI::App& app, const CLI::Option& from) {
  Option option;
  if (from.get_positional()) {
    option.names = {from.get_name(true)};
  } else {
    for (const std::string& name : from.get_snames()) option.names.push_back("-" + name);
    for (const std::string& name : from.get_lnames()) option.names.push_back("--" + name);
  }
  option.help = on_one_line(from.get_description());
  option.group = from.get_group();
  option.flag = !from.get_positional() && from.get_items_expected_max() == 0;
  if (!option.flag) option.value = value_of(from);
  if (option.help.find("default") == std::string::npos) option.standard = from.get_default_str();
  if (option.standard.starts_with("[")) {  // a list, as it is typed
    option.standard = option.standard.substr(1, option.standard.size() - 2);
  }
  option.required = from.get_required();
  option.repeats =
      !option.flag && (from.get_expected_max() > 1 ||
                       from.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll);
  // CLI11 keeps the excluded by their address: the order of the help is the same each time.
  const std::set<CLI::Option*> excludes = from.get_excludes();
  for (const CLI::Option* other : app.get_options()) {
    if (!excludes.contains(const_cast<CLI::Option*>(other))) continue;
    option.excludes.push_back(other->get_positional() ? other->get_name(true)
                                                      : "--" + other->get_lnames().front());
  }
  return option;
}

}  // namespace

Value parse_value(const std::string& name) {
  static const std::regex word("[a-z][a-z0-9-]*"), ending("[A-Z]*\\.([a-z]+)"), file("FILE\\b.*"),
      folder("DIR|FOLDER");
  Value value;
  value.name = name;
  if (name.starts_with("{")) {
    value.words = core::split(name.substr(1, name.size() - 2), ',');
    value.name = name.substr(1, name.size() - 2);
    std::replace(value.name.begin(), value.name.end(), ',', '|');
    return value;
  }
  for (const std::string& part : core::split(name, '|')) {
    std::smatch match;
    if (std::regex_match(part, word)) {
      value.words.push_back(part);
    } else if (std::regex_match(part, match, ending)) {
      value.file = true;
      value.extensions.push_back(match[1]);
    } else if (std::regex_match(part, folder)) {
      value.folder = true;
    } else if (std::regex_match(part, file)) {
      value.file = true;
    }
  }
  return value;
}

Command describe(const CLI::App& app) {
  Command command;
  command.name = app.get_name();
  command.summary = on_one_line(app.get_description());
  const std::string footer = app.get_footer(), before = "Example:\n  ";
  const std::size_t example = footer.find(before);
  if (example != std::string::npos) command.example = footer.substr(example + before.size());
  for (const CLI::Option* option : app.get_options()) {
    (option->get_positional() ? command.arguments : command.options)
        .push_back(option_of(app, *option));
  }
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    command.verbs.push_back(describe(*verb));
  }
  return command;
}

}  // namespace psf::manual
