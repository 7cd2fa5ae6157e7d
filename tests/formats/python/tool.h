// formats/pvb.py as a program: pvb_tool.py, run by Debian's Python.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "../file_bytes.h"
#include "catch.h"

namespace psf::test {

inline const std::string kPython = "/usr/bin/python3";  // Debian's, which has Debian's numpy
inline const std::string kTool = PSF_SOURCE_DIR "/tests/formats/python/pvb_tool.py";

// Why a test of the tool is skipped, or, for the second, stops short of the compressed files.
inline constexpr const char* kNoNumpy = "Debian's python3 has no numpy";
inline constexpr const char* kNoZstandard = "Debian's python3 has no zstandard: zstd was not tried";

inline bool has_module(const std::string& name) {
  return std::system((kPython + " -c 'import " + name + "' 2>/dev/null").c_str()) == 0;
}

// Those that pvb.py can read and write on this machine.
inline std::vector<std::string> codecs() {
  if (!has_module("numpy")) return {};
  if (!has_module("zstandard")) return {"raw"};
  return {"raw", "zstd"};
}

// What the tool prints, which goes through a file of the folder.
inline std::string run_tool(const Scratch& folder, const std::string& arguments) {
  const std::string out = folder.path("out");
  const std::string line = fmt::format("{} '{}' {} >'{}'", kPython, kTool, arguments, out);
  REQUIRE(std::system(line.c_str()) == 0);
  std::ifstream in(out);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline std::string hex(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) text += fmt::format("{:02x}", std::to_integer<int>(byte));
  return text;
}

}  // namespace psf::test
