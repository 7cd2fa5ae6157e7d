// Files of JSON: the document, and where in the file its values stand.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace psf::render {

// Reads and parses. Throws Error{io} where the file cannot be read, Error{bad_input} with line and
// column where it is malformed, an object has the same key twice, or values stand in more than 512
// others.
[[nodiscard]] nlohmann::json read_json(const std::string& path);
// The same of the text of a file.
[[nodiscard]] nlohmann::json parse_json(std::string text, const std::string& path);

// The line of a value, from 1, by the keys and indices on the way to it: "/materials/2/roughness".
// 0 where the file is no text of JSON, as a GLB is not.
[[nodiscard]] std::size_t line_of(const std::string& file, const std::string& path);

}  // namespace psf::render
