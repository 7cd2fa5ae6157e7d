// Parameters as text, for the command line, and for pictures and reports.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "filter/parameters.h"

namespace psf::filter {

// Each of these throws Error{usage} that says what may be written. The comments give examples.
void parse_radius(const std::string& text, Radius& radius);    // 0.02, 8px, 0.5wu: r0 and basis
[[nodiscard]] BlockSize parse_block(const std::string& text);  // 2^16, 16passes, 1pass, all
[[nodiscard]] std::uint32_t parse_sources(const std::string& text);  // 1/4: 4
[[nodiscard]] Estimator parse_estimator(const std::string& text);    // one of kEstimatorNames
// Parses "off" or a number; `option` names the threshold in the error.
[[nodiscard]] std::optional<float> parse_threshold(const std::string& text, const char* option);

[[nodiscard]] std::string to_text(const Radius& radius);  // text that parse_radius() accepts
[[nodiscard]] std::string to_text(const BlockSize& block);
[[nodiscard]] std::string to_text(Estimator estimator);
// The name of the option and the value of every parameter, in the order of the struct.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> describe(
    const Parameters& parameters);

}  // namespace psf::filter
