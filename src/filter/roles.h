// The role of each record of a block: source, query, neither, or left out for non-finite values.
#pragma once

#include <cstdint>
#include <vector>

#include "filter/parameters/parameters.h"
#include "filter/records.h"
#include "filter/statistics.h"

namespace psf::filter {

enum class Role : std::uint8_t {
  left_out,   // a value in use is not finite: it is in no average and no picture
  no_vertex,  // it has u_i alone, and is in both pictures, with and without filter
  unchosen,   // it has u_i alone, but was not chosen: the picture without filter lacks it
  query,      // it has x_i but no c_i: it gets an average, and the picture without filter lacks it
  source      // it has both: it gets an average, is averaged for others, and is in both pictures
};

// Whether a record has a vertex and is in use.
[[nodiscard]] inline bool is_query(Role role) {
  return role == Role::query || role == Role::source;
}
// Whether a path is in the picture without filter, which is the mean of such paths. This does not
// depend on whether the path has a vertex, so no path weighs more than another.
[[nodiscard]] inline bool is_input(Role role) {
  return role == Role::no_vertex || role == Role::source;
}

struct Roles {
  std::vector<Role> of;  // role of each record
  // Record numbers, ascending; sources are queries too.
  std::vector<std::uint32_t> queries, sources;
};

// Finds the role of each record, and looks only at the channels that `parameters` use. hit_distance
// may be infinite (a miss) but not NaN: where an unshaded vertex has NaN, every unshaded record of
// the block is left out and counted for `hit_distance`, so that paths that met nothing weigh no
// more than paths that met a surface. Under demodulation c / rho must be finite too; a record where
// it is not is counted for `reflectance`. Adds to the counts of `statistics`. Records that
// Records::taken leaves to another run are `left_out` and not counted; those without vertex are left
// to that of surfaces.
[[nodiscard]] Roles find_roles(const Records& records, const Block& block,
                               const Parameters& parameters, Statistics& statistics);

}  // namespace psf::filter
