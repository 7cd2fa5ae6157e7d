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
  left_out,   // a value in use is not finite: no part of averages nor pictures
  no_vertex,  // contributes u_i alone
  unchosen,   // the same, but that no part of the picture without filter is made of it
  query,      // has x_i but no c_i: gets an average, gives none, and no part of that picture either
  source      // gets and gives
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
// NaN. Under demodulation c / rho must be finite too; where it is not, that counts for
// `reflectance`. Adds to the counts of `statistics`.
[[nodiscard]] Roles find_roles(const Records& records, const Block& block,
                               const Parameters& parameters, Statistics& statistics);

}  // namespace psf::filter
