// Parses a part of a picture on the command line, "X,Y,WxH".
#pragma once

#include <cstddef>
#include <regex>
#include <string>

#include "core/error.h"

namespace psf::tools {

struct Rectangle {  // pixels
  std::size_t x = 0, y = 0, width = 0, height = 0;
};

// Throws Error{usage} that names the option.
inline Rectangle parse_rectangle(const std::string& text, const std::string& option) {
  static const std::regex form(R"((\d{1,9}),(\d{1,9}),(\d{1,9})x(\d{1,9}))");
  std::smatch parts;
  if (!std::regex_match(text, parts, form)) {
    throw Error(ErrorCode::usage, option + " " + text + ": no region, write X,Y,WxH in pixels");
  }
  return {std::stoul(parts[1]), std::stoul(parts[2]), std::stoul(parts[3]), std::stoul(parts[4])};
}

}  // namespace psf::tools
