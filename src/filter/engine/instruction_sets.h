// The instruction sets that the kernel can use on this machine, and a way to force one of them, for
// tests and benchmarks.
#pragma once

#include <string>
#include <vector>

namespace psf::filter::engine {

// The instruction sets that this program was compiled for and this machine has: "AVX-512", "AVX2",
// "SSE4", "NEON", "scalar", or Highway's name of another. There is at least one; the first is the
// best, and the kernel uses it unless there is an InstructionSetLimit.
[[nodiscard]] std::vector<std::string> instruction_sets();

// The name of the instruction set that the kernel uses now.
[[nodiscard]] std::string instruction_set();

// As long as the object exists, the kernel uses the given set. The limit holds for the whole
// process and for every use of Highway (the sort of search/compact_order.h too); threads inside the
// kernel follow from their next call on. Have one such object at a time, and run no filter while it
// is made or destroyed.
class InstructionSetLimit {
 public:
  // Throws Error{usage} unless `name` is one of instruction_sets().
  explicit InstructionSetLimit(const std::string& name);
  ~InstructionSetLimit();
  InstructionSetLimit(const InstructionSetLimit&) = delete;
  InstructionSetLimit& operator=(const InstructionSetLimit&) = delete;
};

}  // namespace psf::filter::engine
