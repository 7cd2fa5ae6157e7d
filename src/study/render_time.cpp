#include "study/render_time.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/error.h"

namespace psf::study {

RenderTime mean_render_time(std::span<const RenderFigures> renders) {
  RenderTime mean;
  for (const RenderFigures& one : renders) {
    const nlohmann::json json = nlohmann::json::parse(one.json, nullptr, false);
    const auto number = [&](const char* key) {
      if (json.is_object() && json.contains(key) && json[key].is_number()) {
        return json[key].get<double>();
      }
      throw Error(
          ErrorCode::bad_input,
          fmt::format("{}: has no number '{}'; give what psf-render --json wrote", one.name, key));
    };
    const double passes = number("passes"), output = number("output_seconds");
    mean.render += (number("seconds") - output) / passes;
    mean.dump += output / passes;
  }
  const auto count = static_cast<double>(renders.size());
  return {mean.render / count, mean.dump / count};
}

RenderTime read_render_time(std::span<const std::string> paths) {
  std::vector<RenderFigures> renders;
  for (const std::string& path : paths) {
    std::ifstream file(path);
    if (!file) throw Error(ErrorCode::io, path + ": cannot be read");
    renders.push_back({path, std::string(std::istreambuf_iterator<char>(file), {})});
  }
  return mean_render_time(renders);
}

}  // namespace psf::study
