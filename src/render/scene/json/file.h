// Reads JSON files, and finds the lines of their values.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace psf::render {

// Reads and parses a file. Throws Error{io} where it cannot be read, Error{bad_input} with line and
// column where it is malformed, an object has the same key twice, or values are nested more than
// 512 deep.
[[nodiscard]] nlohmann::json read_json(const std::string& path);
// Parses the text of a file, as read_json() does; errors name `path`.
[[nodiscard]] nlohmann::json parse_json(std::string text, const std::string& path);

// The line, from 1, of the value at a JSON pointer such as "/materials/2/roughness"; 0 where the
// file is not JSON text, such as a GLB.
[[nodiscard]] std::size_t line_of(const std::string& file, const std::string& path);

}  // namespace psf::render
