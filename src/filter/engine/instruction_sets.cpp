#include "filter/engine/instruction_sets.h"

#include <cstdint>

#include "core/error.h"
#include "filter/engine/targets.h"

// As in kernel.cpp: a function for each set, one of which is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/engine/instruction_sets.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace psf::filter::engine::HWY_NAMESPACE {

std::int64_t own_target() {
  return HWY_TARGET;
}

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace psf::filter::engine {

HWY_EXPORT(own_target);

namespace {

using Targets = std::int64_t;  // a bit a set, the best one lowest

// Asked once, before any limit.
Targets available() {
  static const Targets targets = hwy::SupportedTargets() & HWY_TARGETS;
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

std::string instruction_set() {
  return name_of(HWY_DYNAMIC_DISPATCH(own_target)());
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

InstructionSetLimit::~InstructionSetLimit() {
  use(0);
}

}  // namespace psf::filter::engine
#endif
