// Catch2 version 2 and version 3 under one name.
#pragma once

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;
#else
#include <catch2/catch.hpp>

namespace psf::tests {

// The number of test cases that SKIP ended; main.cpp turns it into the exit code of version 3.
inline int& skipped_cases() {
  static int count = 0;
  return count;
}

}  // namespace psf::tests

// Version 3's name.
namespace Catch::Matchers {
inline auto ContainsSubstring(const std::string& text) {
  return Contains(text);
}
}  // namespace Catch::Matchers

// Version 3's: ends a test case that cannot be tried on this machine.
#define SKIP(why)                  \
  do {                             \
    ++psf::tests::skipped_cases(); \
    WARN("skipped: " << why);      \
    return;                        \
  } while (false)
#endif
