// A program's command line as plain values, read from CLI11's tables: what man pages and
// completions are written from.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace psf::manual {

// What an option or an argument takes.
struct Value {
  std::string name;                // as the help has it: "FILE.pvb", "T|off"
  std::vector<std::string> words;  // that can be typed as they stand: "off", "sobol"
  std::vector<std::string>
      extensions;  // of the files wanted: "pvb"; empty with `file`: of any file
  bool file = false, folder = false;
};

struct Option {
  std::vector<std::string> names;     // "-o", "--output"; of an argument its one name, "IN"
  std::string help, group, standard;  // `standard`: the value unless given, where the help lacks it
  Value value;
  bool flag = false, required = false, repeats = false;
  std::vector<std::string> excludes;  // long names, in the order of the help
};

struct Command {
  std::string name;  // the last word of "psf filter"
  std::string summary, example;
  std::vector<Option> options, arguments;
  std::vector<Command> verbs;
};

[[nodiscard]] Command describe(const CLI::App& app);

// What a value's name says: words of small letters can be typed, FILE, DIR and .ending are files
// and folders, other capitals stand for something. Braces hold words of any letters.
[[nodiscard]] Value parse_value(const std::string& name);

}  // namespace psf::manual
