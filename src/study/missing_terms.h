// Weights that a dump cannot serve: what nobody asked for is done without.
#pragma once

#include <span>
#include <string>

#include "filter/parameters.h"
#include "filter/weights.h"
#include "study/dump.h"

namespace psf::study {

// Switches off, in every set, the terms that look at a channel that `dump` does not have, but for
// those `asked` for, which Dump::select() refuses. Returns a line that names all of them, the dump
// and the channels; empty where there is nothing to say.
[[nodiscard]] std::string switch_off_missing(const Dump& dump, std::span<filter::Parameters> sets,
                                             filter::TermSet asked);

}  // namespace psf::study
