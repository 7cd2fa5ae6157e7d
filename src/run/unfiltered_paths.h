// The paths that the picture without filter is made of, one after the other, with what other
// denoisers want to know of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "core/vec.h"
#include "run/dump.h"
#include "run/passes.h"

namespace psf::run {

struct UnfilteredPath {
  std::size_t camera = 0;   // index in Dump::cameras()
  std::uint32_t pixel = 0;  // y * width + x
  // Whether it is in the picture without filter: all are, but those that were not shaded.
  bool in_picture = false;
  Rgb radiance;     // u + alpha c; 0 where it is not in the picture
  Rgb reflectance;  // rho_i; 0 without vertex, and where the dump has no such channel
  Vec3 normal;      // n_i; the same
  float distance;   // d_i; the same
};

struct UnfilteredCounts {
  std::uint64_t passes = 0, paths = 0;        // of the selection
  std::uint64_t left_out = 0, overflows = 0;  // of these, not finite, and u + alpha c is not
};

// Calls visit(paths) with all paths of the selection that `psf filter` takes into its pictures with
// its defaults: whatever it reads of them is finite. Threads share the pixels, so `visit` is called
// from several at once; the paths of a pixel come in path order and from one thread. The memory is
// that of two times 2^18 records, whatever the dump's length. In a dump with unshaded vertices whose
// metadata do not tell its shade rate, which of the paths without vertex are in the picture is
// chosen by block, and blocks of 2^18 paths choose others than those of the filter.
// `progress` is called with numbers of paths, from the calling thread. Throws Error{usage} for
// passes, Error{interrupted} and what Dump::select() and Dump::read() throw.
UnfilteredCounts for_each_unfiltered_path(
    const Dump& dump, const PassSelection& passes,
    const std::function<void(std::span<const UnfilteredPath>)>& visit,
    const std::function<void(std::uint64_t done, std::uint64_t total)>& progress = {});

}  // namespace psf::run
