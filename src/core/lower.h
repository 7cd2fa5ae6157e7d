// Lower case of ASCII letters, for names that are compared without regard to case.
#pragma once

#include <string>
#include <string_view>

namespace psf::core {

[[nodiscard]] inline std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return result;
}

}  // namespace psf::core
