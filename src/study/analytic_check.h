// Are the slopes of convergence those of theory? Asked of the built-in scenes.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "filter/parameters/parameters.h"
#include "study/analytic.h"
#include "study/converge_file.h"

namespace psf::study {

inline constexpr double kSlopeTolerance = 0.1;  // the difference that a slope may have

// Studies a scene over replicates, whose dumps are written to a folder of their own in `folder`,
// which must exist, and removed in the end whatever happens. Of `sets`, r0 (in pixels) and delta
// are used; blocks are of one pass, and there are no weights, as theory has it. The report has a
// check of bias and one of variance for each set; its version is left to the caller. Throws what
// converge() throws.
[[nodiscard]] ConvergeReport check_analytic(
    AnalyticScene scene, std::span<const filter::Parameters> sets, const std::string& folder,
    const std::function<void(std::uint64_t done, std::uint64_t total)>& on_progress);

}  // namespace psf::study
