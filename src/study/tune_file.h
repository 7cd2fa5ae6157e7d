// The file of psf tune --json, which psf filter --tuned reads.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "study/study_file.h"
#include "study/tune.h"

namespace psf::study {

// The rows, least error first.
[[nodiscard]] std::vector<const TuneRow*> by_error(const TuneResult& tuning);
// How many sets may be better than the choice; 0: the choice is sure.
[[nodiscard]] std::size_t may_be_better(const TuneResult& tuning);

// `request`: what tune() was asked for on this dump.
[[nodiscard]] Json to_json(const TuneResult& tuning, const run::Dump& dump,
                           const TuneRequest& request, const std::string& version);

}  // namespace psf::study
