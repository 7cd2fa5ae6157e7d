// psf relight: weighs the lights of a picture that has them as layers.
#include "film/relight.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli.h"
#include "core/error.h"
#include "core/json_text.h"
#include "core/parallel.h"
#include "core/text.h"
#include "option_values.h"
#include "verbs.h"

namespace psf::tools {
namespace {

using Json = nlohmann::ordered_json;

struct RelightOptions {
  CommonOptions common;
  std::string input;
  std::vector<std::string> weights;  // "LAYER=W" or "LAYER=R,G,B"
  std::vector<std::string> outputs;
};

// One number, or three with commas between; none for other text.
std::optional<Rgb> parse_weight(std::string_view text) {
  std::vector<float> values;
  for (const std::string& part : core::split(text, ',')) {
    const auto value = parse_number<float>(part);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  if (values.size() == 1) return Rgb(values[0]);
  if (values.size() == 3) return Rgb(values[0], values[1], values[2]);
  return std::nullopt;
}

film::LightWeights weights_of(const std::vector<std::string>& texts) {
  film::LightWeights weights;
  for (const std::string& text : texts) {
    const std::size_t equals = std::min(text.rfind('='), text.size());
    const std::string layer = text.substr(0, equals);
    const auto weight =
        parse_weight(std::string_view(text).substr(std::min(equals + 1, text.size())));
    if (layer.empty() || !weight) {
      throw Error(ErrorCode::usage,
                  fmt::format("'{}' is no weight: write LAYER=W or LAYER=R,G,B", text));
    }
    if (!weights.emplace(layer, *weight).second) {
      throw Error(ErrorCode::usage, fmt::format("layer {} is given twice", layer));
    }
  }
  return weights;
}

// The light of colours, negative light too.
double light_of(const std::vector<Rgb>& colors) {
  double sum = 0;
  for (const Rgb& color : colors) sum += std::abs(double{luminance(color)});
  return sum;
}

// The layers, and the background that is apart, with their shares of the light that is seen.
Json shares_of(const film::Image& image, const film::LightWeights& weights) {
  Json rows = Json::array();
  const double all = light_of(image.seen());
  std::vector<std::string> layers = film::light_layers_of(image);
  if (image.has_background()) layers.emplace_back(film::kBackground);
  for (const std::string& layer : layers) {
    const double share = all > 0 ? light_of(image.rgb(layer + ".")) / all : 0;
    const auto given = weights.find(layer);
    const Rgb weight = given == weights.end() ? Rgb(1) : given->second;
    rows.push_back(
        {{"layer", layer}, {"share", share}, {"weight", {weight.x, weight.y, weight.z}}});
  }
  return rows;
}

void print(const Json& rows) {
  fmt::print("{:<24}{:>12}  weight\n", "layer", "of new light");
  for (const Json& row : rows) {
    const auto weight = row.at("weight").get<std::vector<float>>();
    fmt::print("{:<24}{:>11.1f}%  {} {} {}\n", row.at("layer").get<std::string>(),
               100 * row.at("share").get<double>(), weight[0], weight[1], weight[2]);
  }
}

void run(const RelightOptions& options) {
  const core::ThreadLimit threads(options.common.threads);
  const film::LightWeights weights = weights_of(options.weights);
  for (const std::string& path : options.outputs) film::check_image_path(path);
  std::vector<std::string> outputs = options.outputs;
  outputs.push_back(options.common.json);
  check_files({options.input}, outputs);
  const film::Image image = film::relight(film::read_exr(options.input), weights);
  for (const std::string& path : options.outputs) film::write_image(path, image);
  const Json rows = shares_of(image, weights);
  if (!options.common.json.empty()) {
    const Json json = {{"input", options.input}, {"layers", rows}, {"written", options.outputs}};
    core::write_json_file(options.common.json, json);
  }
  print(rows);
  for (const std::string& path : options.outputs) fmt::print("wrote {}\n", path);
}

}  // namespace

void add_relight(CLI::App& app) {
  auto options = std::make_shared<RelightOptions>();
  CLI::App* command =
      app.add_subcommand("relight", "weigh the lights of a picture that has them as layers");
  command->add_option("IN", options->input, "picture of psf filter with layers of the light")
      ->required()
      ->type_name("FILE.exr");
  command
      ->add_option("WEIGHTS", options->weights,
                   "what the light of a layer is multiplied with; others keep theirs")
      ->type_name("LAYER=W|LAYER=R,G,B");
  command
      ->add_option("-o,--output", options->outputs,
                   "picture, .exr with the layers or .png; may be repeated; none: only tells what "
                   "the layers are")
      ->type_name("FILE.exr|.png")
      ->allow_extra_args(false);
  add_common(*command, options->common);
  set_example(*command, "psf relight filtered.exr sun=0.2 sky=0.5,0.6,1 -o evening.exr");
  command->callback([options] { run(*options); });
}

}  // namespace psf::tools
