// Switches off the terms of w_ij whose channel a dump lacks, unless the user asked for them.
#pragma once

#include <span>
#include <string>

#include "filter/parameters/parameters.h"
#include "filter/weights.h"
#include "run/dump.h"

namespace psf::run {

// Switches off, in every set, the terms that compare a channel that `dump` does not have, except
// those in `asked`, for which Dump::select() will throw, and the terms that the estimator cannot
// apply, of which those in `asked` throw Error{usage}. Returns a line that names these terms, the
// dump and the channels; empty where there are none.
[[nodiscard]] std::string switch_off_missing(const Dump& dump, std::span<filter::Parameters> sets,
                                             filter::TermSet asked);

}  // namespace psf::run
