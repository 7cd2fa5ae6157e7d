// Options whose text becomes a value (numbers within limits), and the wrapping of help texts.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/number.h"

namespace psf::tools {

using core::parse_number;

// Adds an option. parse(text) stores the value and returns true, or returns false where `text` is
// not what was `expected`.
template <class Parse>
CLI::Option* add_parsed(CLI::App& app, const std::string& name, const std::string& type,
                        const std::string& expected, const std::string& help, Parse parse) {
  const auto callback = [=](const std::string& text) {
    if (parse(text)) return;
    throw CLI::ValidationError(name, fmt::format("expected {}, got \"{}\"", expected, text));
  };
  return app.add_option_function<std::string>(name, callback, help)->type_name(type);
}

// Adds an option whose value is a number from `least` to `most`.
template <class T>
CLI::Option* add_number(CLI::App& app, const std::string& name, T& target, T least, T most,
                        const std::string& help) {
  const bool bounded = most < std::numeric_limits<T>::max();
  const std::string expected = fmt::format(
      "{} {}", std::is_integral_v<T> ? "a whole number" : "a number",
      bounded ? fmt::format("from {} to {}", least, most) : fmt::format("of at least {}", least));
  auto* option =
      add_parsed(app, name, "N", expected, help, [&target, least, most](const std::string& text) {
        const auto number = parse_number<T>(text);
        if (!number || *number < least || *number > most) return false;
        target = *number;
        return true;
      });
  if (std::isfinite(static_cast<double>(target))) {
    option->default_str(fmt::format("{}", target));
  }
  return option;
}

// The same without a largest value.
template <class T>
CLI::Option* add_number(CLI::App& app, const std::string& name, T& target, T least,
                        const std::string& help) {
  return add_number(app, name, target, least, std::numeric_limits<T>::max(), help);
}

// Breaks a help text into lines that fit beside the options' names.
inline std::string wrap(const std::string& text) {
  constexpr std::size_t kWidth = 68;
  std::string result;
  std::size_t line = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    if (line + end - begin > kWidth && line > 0) {
      result += '\n';
      line = 0;
    } else if (line > 0) {
      result += ' ';
      ++line;
    }
    result += text.substr(begin, end - begin);
    line += end - begin;
    begin = end + 1;
  }
  return result;
}

inline void wrap_descriptions(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    option->description(wrap(option->get_description()));
  }
}

}  // namespace psf::tools
