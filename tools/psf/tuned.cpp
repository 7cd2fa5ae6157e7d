#include "tuned.h"

#include <fmt/format.h>

#include "core/error.h"
#include "option_values.h"
#include "study/study_file.h"

namespace psf::tools {

void read_tuned(const std::string& path, ParameterOptions& options) {
  const std::string remedy = "give what psf tune --json wrote";
  const study::Json json = study::read_study_file(path, "tune", remedy);
  const auto text = [&](const char* option) {
    const study::Json::json_pointer place(std::string("/best/parameters/") + option);
    if (json.contains(place) && json[place].is_string()) return json[place].get<std::string>();
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: {}: expected a text; {}", path, place.to_string(), remedy));
  };
  const auto number = [&](const char* option, auto& target) {
    const auto value = parse_number<std::remove_reference_t<decltype(target)>>(text(option));
    if (!value) {
      throw Error(
          ErrorCode::bad_input,
          fmt::format("{}: /best/parameters/{}: expected a number; {}", path, option, remedy));
    }
    target = *value;
  };
  options.r0 = text("r0");
  number("delta", options.delta);
  options.radius_count = text("radius-count");
  options.block = text("block");
  options.normal = text("normal");
  options.reflectance = text("reflectance");
  options.visibility = text("visibility") == "on";
  options.hit_distance = text("hit-distance");
  options.plane = text("plane");
  options.direction = text("direction");
  options.gloss = text("gloss");
  options.material = text("material") == "on";
  options.demodulate = text("demodulate") == "on";
  number("iterations", options.iterations);
  options.sources = text("sources");
  options.estimator = text("estimator");
  if (text("agree") != "off") number("agree", options.agree);
}

}  // namespace psf::tools
