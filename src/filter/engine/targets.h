// For which instruction sets the kernel is compiled. The first header of Highway in a source.
#pragma once

// SSE4, AVX2, AVX-512 and NEON, beside what every machine of the kind has: newer sets (lower bits)
// are more code to test and no faster here.
#define HWY_DISABLED_TARGETS \
  ((HWY_AVX3 - 1) | HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)

#include <hwy/targets.h>
