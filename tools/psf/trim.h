// The share of the pixels that --trim leaves out, "0.1%" or "0.001".
#pragma once

#include <charconv>
#include <string>
#include <system_error>

#include "core/error.h"

namespace psf::tools {

// Empty text: nothing. Throws Error{usage} for what is no share below 1.
inline double parse_trim(const std::string& text) {
  if (text.empty()) return 0;
  const bool percent = text.back() == '%';
  const char* end = text.data() + text.size() - (percent ? 1 : 0);
  double share = 0;
  const auto [rest, error] = std::from_chars(text.data(), end, share);
  if (percent) share /= 100;
  if (error != std::errc() || rest != end || !(share >= 0 && share < 1)) {
    throw Error(ErrorCode::usage, "--trim " + text + ": no share, write 0.1% or 0.001, below 1");
  }
  return share;
}

}  // namespace psf::tools
