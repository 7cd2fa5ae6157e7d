// The instruction sets that the kernel is compiled for. Include it before any header of Highway.
#pragma once

// Kept are SSE4, AVX2, AVX-512 and NEON, beside the baseline of the machine. Newer sets (lower
// bits) are more code to test and no faster here.
#define HWY_DISABLED_TARGETS \
  ((HWY_AVX3 - 1) | HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)

#include <hwy/targets.h>
