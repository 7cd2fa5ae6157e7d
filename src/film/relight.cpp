#include "film/relight.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text.h"

namespace psf::film {
namespace {

constexpr const char* kRelight = "psf:relight";
constexpr const char* kColours = "RGB";
// The layers of a pixel that add up to its light but for this share of it are all of its light.
constexpr double kRounding = 1e-5;

std::vector<float>& channel_of(Image& image, const std::string& name) {
  const auto found = std::find_if(image.layers.begin(), image.layers.end(),
                                  [&](const Layer& layer) { return layer.channel == name; });
  if (found == image.layers.end()) {
    throw Error(ErrorCode::bad_input, fmt::format("{}: has no channel {}, though {} names it",
                                                  image.path, name, kLightLayers));
  }
  return found->values;
}

// Multiplies the layers behind `prefix`, and its colours accordingly.
void weigh(Image& image, const std::string& prefix, const std::vector<std::string>& layers,
           const LightWeights& weights) {
  struct Sums {
    double before = 0, after = 0, size = 0;
  };
  std::vector<Sums> sums(image.width * image.height);
  for (int c = 0; c < 3; ++c) {
    std::fill(sums.begin(), sums.end(), Sums());
    for (const std::string& layer : layers) {
      const auto given = weights.find(layer);
      const float weight = given == weights.end() ? 1 : given->second[c];
      std::vector<float>& values = channel_of(image, prefix + layer + "." + kColours[c]);
      for (std::size_t pixel = 0; pixel < sums.size(); ++pixel) {
        sums[pixel].before += double{values[pixel]};
        sums[pixel].size += std::abs(double{values[pixel]});
        values[pixel] *= weight;
        sums[pixel].after += double{values[pixel]};
      }
    }
    std::vector<float>& all = channel_of(image, prefix + kColours[c]);
    for (std::size_t pixel = 0; pixel < sums.size(); ++pixel) {
      const auto& [before, after, size] = sums[pixel];
      const double rest = double{all[pixel]} - before;
      const bool is_rounding = std::abs(rest) <= kRounding * size;
      all[pixel] = static_cast<float>(is_rounding ? after : rest + after);
    }
  }
}

void weigh_background(Image& image, const std::string& prefix, const LightWeights& weights) {
  const auto given = weights.find(kBackground);
  if (given == weights.end() || !image.has_background(prefix)) return;
  for (int c = 0; c < 3; ++c) {
    for (float& value : channel_of(image, prefix + kBackground + "." + kColours[c])) {
      value *= given->second[c];
    }
  }
}

std::string text_of(const LightWeights& weights) {
  std::vector<std::string> texts;
  for (const auto& [layer, weight] : weights) {
    texts.push_back(weight.x == weight.y && weight.y == weight.z
                        ? fmt::format("{}={}", layer, weight.x)
                        : fmt::format("{}={},{},{}", layer, weight.x, weight.y, weight.z));
  }
  return fmt::format("{}", fmt::join(texts, " "));
}

}  // namespace

std::vector<std::string> light_layers_of(const Image& image) {
  for (const auto& [name, text] : image.attributes) {
    if (name == kLightLayers) return core::split(text, ',');
  }
  return {};
}

Image relight(const Image& image, const LightWeights& weights) {
  const std::vector<std::string> layers = light_layers_of(image);
  std::vector<std::string> names = layers;
  if (image.has_background()) names.emplace_back(kBackground);
  if (names.empty()) {
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: has no layers of the light; psf-render --layers lights writes "
                            "them into a dump, and psf filter into the picture",
                            image.path));
  }
  for (const auto& [layer, weight] : weights) {
    if (std::find(names.begin(), names.end(), layer) != names.end()) continue;
    throw Error(ErrorCode::usage, fmt::format("{}: has no layer {} of the light; there are {}",
                                              image.path, layer, fmt::join(names, ", ")));
  }
  for (const auto& [layer, weight] : weights) {
    if (is_finite(weight)) continue;
    throw Error(ErrorCode::usage,
                fmt::format("{}: the weight of layer {} is not finite", image.path, layer));
  }
  Image result = image;
  const std::string unfiltered = std::string(kUnfiltered) + ".";
  for (const std::string& prefix : {std::string(), unfiltered}) {
    const bool has_layers =
        !layers.empty() &&
        (prefix.empty() || result.find(prefix + layers.front() + ".R") != nullptr);
    if (has_layers) weigh(result, prefix, layers, weights);
    weigh_background(result, prefix, weights);
  }
  const auto before =
      std::find_if(result.attributes.begin(), result.attributes.end(),
                   [](const auto& attribute) { return attribute.first == kRelight; });
  if (before == result.attributes.end()) {
    result.attributes.emplace_back(kRelight, text_of(weights));
  } else {
    before->second += "; " + text_of(weights);
  }
  std::sort(result.attributes.begin(), result.attributes.end());  // as they come out of a file
  return result;
}

}  // namespace psf::film
