// A whole file as text.
#pragma once

#include <fstream>
#include <iterator>
#include <string>

namespace psf::tests {

[[nodiscard]] inline std::string read_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace psf::tests
