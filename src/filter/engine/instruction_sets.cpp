#include "filter/engine/instruction_sets.h"

#include <algorithm>
#include <cstdint>

#include "core/error.h"
// Must come before Highway's.
#include "filter/engine/targets.h"

#include <hwy/highway.h>
#include <hwy/targets.h>

namespace psf::filter::engine {
namespace {

using Targets = std::int64_t;  // a bit a set, the best one lowest

// Asked once, before any limit. Where there is one set alone Highway does not ask the machine.
Targets available() {
  static const Targets targets = HWY_SUPPORTED_TARGETS & HWY_TARGETS;
  return targets != 0 ? targets : HWY_STATIC_TARGET;
}

std::string name_of(Targets target) {
  if (target == HWY_AVX3) return "AVX-512";
  if (target == HWY_EMU128 || target == HWY_SCALAR) return "scalar";
  return hwy::TargetName(target);
}

void use(Targets targets) {
  hwy::SetSupportedTargetsForTest(targets);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace

std::vector<std::string> instruction_sets() {
  std::vector<std::string> names;
  for (Targets left = available(); left != 0; left &= left - 1) {
    names.push_back(name_of(left & -left));
  }
  return names;
}

InstructionSetLimit::InstructionSetLimit(const std::string& name) {
  for (Targets left = available(); left != 0; left &= left - 1) {
    if (name_of(left & -left) != name) continue;
    // With all that are worse, for code that was not compiled for this one.
    use(left);
    return;
  }
  throw Error(ErrorCode::usage, "there is no instruction set " + name + " here");
}

InstructionSetLimit::~InstructionSetLimit() { use(0); }

}  // namespace psf::filter::engine
