// What each record of a block is to the filter: source, query, neither, or left out for non-finite
// values.
#pragma once

#include <cstdint>
#include <vector>

#include "filter/parameters.h"
#include "filter/records.h"
#include "filter/statistics.h"

namespace psf::filter {

enum class Role : std::uint8_t {
  left_out,   // a value in use is not finite: it is in no average and no picture
  no_vertex,  // it has u_i alone, which both pictures show, the filtered one and that without
              // filter
  unchosen,   // the same, but `--sources` did not choose it: the picture without filter lacks it
  query,      // it has x_i but no c_i: it gets an average, and the picture without filter lacks it
  source      // it has both: it gets an average, is averaged for others, and is in both pictures
};

// Has a vertex, and is in use.
[[nodiscard]] inline bool is_query(Role role) {
  return role == Role::query || role == Role::source;
}
// The picture without filter is the mean of these paths. Whether a path is among them does not
// depend on whether it has a vertex, so no path weighs more than another.
[[nodiscard]] inline bool is_input(Role role) {
  return role == Role::no_vertex || role == Role::source;
}

struct Roles {
  std::vector<Role> of;  // by record
  std::vector<std::uint32_t> queries,
      sources;  // record numbers, ascending; sources are queries too
};

// Looks only at the channels that `parameters` use. `hit_distance` may be infinite (a miss), not
// NaN: where it is of an unshaded vertex, all of the block that is not shaded is left out, so that
// what met nothing weighs no more than what met a surface, and counts for `hit_distance`. Under
// demodulation c / rho must be finite too; where it is not, that counts for `reflectance`. Adds to
// the counts of `statistics`.
[[nodiscard]] Roles find_roles(const Records& records, const Block& block,
                               const Parameters& parameters, Statistics& statistics);

}  // namespace psf::filter
