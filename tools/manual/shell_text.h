// What the completions of all shells are put together from.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "manual/command_line.h"

namespace psf::manual {

inline std::string joined(const std::vector<std::string>& parts, const std::string& separator) {
  std::string text;
  for (const std::string& part : parts) text += (&part == &parts[0] ? "" : separator) + part;
  return text;
}

// A name for functions: "psf_render".
inline std::string identifier(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

// The first lines of a file.
inline std::string note(const Command& program) {
  return "# Completion for " + program.name + ", made from its options when psf was built.\n";
}

// Every `from` replaced, as quoting asks for it.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

// The beginning of a help text, short enough for a line of a shell's list.
inline std::string brief(const std::string& help) {
  std::string text = help.substr(0, std::min(help.find("; "), help.find(" (default")));
  constexpr std::size_t kWidth = 60;
  if (text.size() > kWidth) text = text.substr(0, text.find(": "));
  return text;
}

}  // namespace psf::manual
