// What is fuzzed: functions that take any bytes and throw only where the library broke a promise.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>

namespace psf::fuzz {

using Bytes = std::span<const std::byte>;

// A promise that was broken; an Error of the library is caught by the targets.
struct Broken : std::logic_error {
  using std::logic_error::logic_error;
};
inline void demand(bool kept, const std::string& promise) {
  if (!kept) throw Broken(promise);
}

// A file: opened, every column read, whole, in part and as floats; then checked. A file that the
// check finds without fault is readable to the last value.
void fuzz_open(Bytes bytes);
// A file: recovered; the result has no fault, and what lost nothing lost nothing.
void fuzz_recover(Bytes bytes);
// A column: the first byte says what it is decoded as, two more how long it should be.
void fuzz_decode(Bytes bytes);
// Metadata or a directory: the first byte says of what.
void fuzz_metadata(Bytes bytes);

struct Target {
  const char* name;  // name of its folder in the corpus
  void (*run)(Bytes);
};
inline constexpr std::array kTargets = {Target{"open", fuzz_open}, Target{"recover", fuzz_recover},
                                        Target{"decode", fuzz_decode},
                                        Target{"metadata", fuzz_metadata}};

}  // namespace psf::fuzz
