#include "render/light/tally.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>

#include "core/error.h"
#include "film/light_layers.h"

namespace psf::render {
namespace {

constexpr const char* kSky = "sky";
constexpr std::size_t kLongestName = 40;  // what fits a channel's name, with a number behind

std::string channel_name(std::string name) {
  if (name.size() > kLongestName) name.resize(kLongestName);
  std::replace_if(
      name.begin(), name.end(),
      [](unsigned char c) { return c >= 0x80 || (std::isalnum(c) == 0 && c != '-'); }, '_');
  if (name.starts_with('-')) name.front() = '_';  // it would be an option
  return name;
}

}  // namespace

LayerPlan::LayerPlan(LayerKind kind, const Lights& lights) : kind_(kind) {
  if (kind == LayerKind::bounces) {
    layers_ = {{"direct", true, false}, {"indirect", true, false}, {"camera", false, true}};
  }
  if (kind == LayerKind::lobes) {
    layers_ = {{"diffuse", true, false}, {"glossy", true, false}, {"camera", false, true}};
  }
  if (kind != LayerKind::lights) return;
  const std::vector<std::string> sources = lights.names();
  std::map<std::string, std::size_t> numbers;
  std::vector<std::string> taken = {kSky, film::kBackground};
  for (const std::string& source : sources) {
    const auto [found, is_new] = numbers.emplace(source, layers_.size());
    of_light_.push_back(found->second);
    if (!is_new) continue;
    const std::string stem = channel_name(source);
    std::string name = stem;
    const auto is_taken = [&] {
      return !film::why_no_layer_name(name).empty() ||
             std::find(taken.begin(), taken.end(), name) != taken.end();
    };
    for (int k = 2; is_taken(); ++k) name = fmt::format("{}_{}", stem, k);
    taken.push_back(name);
    layers_.push_back({name});
  }
  if (lights.has_sky()) layers_.push_back({kSky});
  of_light_.push_back(layers_.empty() ? 0 : layers_.size() - 1);
  if (layers_.size() > kMost) {
    throw Error(ErrorCode::usage,
                fmt::format("`layers`: lights and sky would be {} layers, and at most {} are "
                            "possible; give lights that belong together one name",
                            layers_.size(), kMost));
  }
}

}  // namespace psf::render
