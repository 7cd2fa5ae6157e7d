// JSON as text: the one place where it is made, because names are bytes and JSON is UTF-8.
#pragma once

#include <string>

#include "core/output_file.h"

namespace psf::core {

// The text of a JSON value of nlohmann's library. Bytes of strings that are not UTF-8 become
// U+FFFD. With `indent` -1 the text is one line.
template <class Json>
[[nodiscard]] std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

// The same as its file is written.
template <class Json>
[[nodiscard]] std::string json_file_text(const Json& json, int indent = 2) {
  return json_text(json, indent) + "\n";
}

template <class Json>
void write_json_file(const std::string& path, const Json& json, int indent = 2) {
  write_text_file(path, json_file_text(json, indent));
}

}  // namespace psf::core
