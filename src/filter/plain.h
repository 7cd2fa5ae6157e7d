// The plain engine: one neighbour search a query, one loop over what it found.
#pragma once

#include <memory>

#include "filter/problem.h"

namespace psf::filter {

// `kind`: plain or brute.
[[nodiscard]] std::unique_ptr<Engine> make_plain(search::Kind kind, const Problem& problem);

}  // namespace psf::filter
