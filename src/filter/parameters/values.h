// Values of parameters as text, both ways; text.h has the table that says which parameter is what.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "filter/parameters/parameters.h"

namespace psf::filter {

// 8px, 0.02, 0.5wu; 2^16, 16passes, 1pass, all; a threshold or off; on or off.
[[nodiscard]] std::string to_text(const Radius& radius);
[[nodiscard]] std::string to_text(const BlockSize& block);
[[nodiscard]] std::string to_text(const std::optional<float>& threshold);
[[nodiscard]] std::string to_text(const FireflyRule& rule);  // keep, spread, clamp:4
[[nodiscard]] std::string to_text(bool on);

// These throw Error{usage} that names the parameter and says what may be written.
[[nodiscard]] double parse_real(const char* name, const std::string& text);  // may be infinite
[[nodiscard]] std::uint32_t parse_count(const char* name, const std::string& text);
[[nodiscard]] bool parse_switch(const char* name, const std::string& text);
[[nodiscard]] std::optional<float> parse_threshold(const char* name, const std::string& text);
// The place of `text` among the names.
[[nodiscard]] std::size_t parse_name(const char* name, const std::string& text,
                                     std::span<const std::string_view> names);
void parse_radius(const std::string& text, Radius& radius);  // its r0 and basis
[[nodiscard]] BlockSize parse_block(const std::string& text);
[[nodiscard]] FireflyRule parse_fireflies(const std::string& text);
[[nodiscard]] std::uint32_t parse_sources(const std::string& text);  // 4 for 1/4

}  // namespace psf::filter
