#include "study/render_time.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace psf::study {

RenderTime read_render_time(std::span<const std::string> paths) {
  RenderTime mean;
  for (const std::string& path : paths) {
    std::ifstream file(path);
    if (!file) throw Error(ErrorCode::io, path + ": cannot be read");
    const nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
    const auto number = [&](const char* key) {
      if (json.is_object() && json.contains(key) && json[key].is_number()) {
        return json[key].get<double>();
      }
      throw Error(
          ErrorCode::bad_input,
          fmt::format("{}: has no number '{}'; give what psf-render --json wrote", path, key));
    };
    const double passes = number("passes"), output = number("output_seconds");
    mean.render += (number("seconds") - output) / passes;
    mean.dump += output / passes;
  }
  const auto count = static_cast<double>(paths.size());
  return {mean.render / count, mean.dump / count};
}

}  // namespace psf::study
