#include "tuned.h"

#include <fmt/format.h>

#include "core/error.h"
#include "filter/parameters/text.h"
#include "study/study_file.h"

namespace psf::tools {

void read_tuned(const std::string& path, filter::ParameterTexts& options, std::string& vertex) {
  const std::string remedy = "give what psf tune --json wrote";
  const study::Json json = study::read_study_file(path, "tune", remedy);
  for (const filter::Parameter& parameter : filter::parameter_table()) {
    const std::string name = parameter.name;
    if (name == "search") continue;  // how to find the neighbours is the user's to say
    const study::Json::json_pointer place("/best/parameters/" + name);
    const bool is_text = json.contains(place) && json[place].is_string();
    try {
      if (!is_text) throw Error(ErrorCode::bad_input, "expected a text");
      filter::Parameters checked;
      parameter.set(checked, json[place].get<std::string>());
    } catch (const Error& error) {
      throw Error(ErrorCode::bad_input,
                  fmt::format("{}: {}: {}; {}", path, place.to_string(), error.what(), remedy));
    }
    options.given[name] = json[place].get<std::string>();
  }
  const study::Json::json_pointer place("/input/vertex");
  if (!vertex.empty() || !json.contains(place)) return;
  if (!json[place].is_string()) {
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: {}: expected a text; {}", path, place.to_string(), remedy));
  }
  vertex = json[place].get<std::string>();
}

}  // namespace psf::tools
