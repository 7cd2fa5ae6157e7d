// Which instruction sets the kernel can use here, and how to hold it to one of them: for tests and
// benchmarks alone.
#pragma once

#include <string>
#include <vector>

namespace psf::filter::engine {

// Those that this program was compiled for and this machine has: "AVX-512", "AVX2", "SSE4", "NEON",
// "scalar", or what Highway calls others. At least one; the first is the best, which the kernel
// uses.
[[nodiscard]] std::vector<std::string> instruction_sets();

// The one in use now.
[[nodiscard]] std::string instruction_set();

// While it lives the kernel uses this set. It holds for the whole process, for whatever else calls
// Highway too (the sort of search/compact_order.h), and for threads that are in the kernel from
// their next call on: have one at a time, and no filter at work when it comes and goes.
class InstructionSetLimit {
 public:
  // Throws Error{usage} unless `name` is one of instruction_sets().
  explicit InstructionSetLimit(const std::string& name);
  ~InstructionSetLimit();
  InstructionSetLimit(const InstructionSetLimit&) = delete;
  InstructionSetLimit& operator=(const InstructionSetLimit&) = delete;
};

}  // namespace psf::filter::engine
