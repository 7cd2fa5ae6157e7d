#include "run/light_layers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "film/light_layers.h"

namespace psf::run {
namespace {

[[noreturn]] void refuse_layer(const formats::Reader& reader, const std::string& why) {
  throw Error(ErrorCode::bad_input, fmt::format("{}: {}", reader.path(), why));
}

// `channel`: of a layer that is wanted.
void check_channel(const formats::Reader& reader, const formats::Channel& channel,
                   std::string_view layer) {
  using formats::Type;
  const bool is_float =
      channel.type == Type::f16 || channel.type == Type::f32 || channel.type == Type::f64;
  std::string why = film::why_no_layer_name(layer);
  if (why.empty() && (!is_float || channel.components != 3)) {
    why = fmt::format("it is {} x {}, and layers of the light are f32 x 3",
                      formats::name_of(channel.type), channel.components);
  }
  if (why.empty()) return;
  refuse_layer(reader,
               fmt::format("channel {0}: {1}; `layers none` does without, and psf cat --drop "
                           "{0} leaves it out",
                           channel.name, why));
}

void check_layer(const formats::Reader& reader, const LightLayer& layer) {
  for (const auto& place : {layer.contribution, layer.unfiltered}) {
    if (place) check_channel(reader, reader.head().channels[*place], layer.name);
  }
}

template <class Layers>
auto find_layer(Layers& layers, std::string_view name) {
  return std::find_if(layers.begin(), layers.end(),
                      [&](const LightLayer& layer) { return layer.name == name; });
}

std::vector<LightLayer> all_layers(const formats::Reader& reader) {
  std::vector<LightLayer> layers;
  const std::vector<formats::Channel>& channels = reader.head().channels;
  for (std::size_t k = 0; k < channels.size(); ++k) {
    for (const auto& [prefix, place] :
         {std::pair(std::string_view("contribution."), &LightLayer::contribution),
          std::pair(std::string_view("unfiltered."), &LightLayer::unfiltered)}) {
      std::string_view name = channels[k].name;
      if (!name.starts_with(prefix) || name.size() == prefix.size()) continue;
      name.remove_prefix(prefix.size());
      auto layer = find_layer(layers, name);
      if (layer == layers.end()) {
        layer = layers.insert(layers.end(), LightLayer{std::string(name), {}, {}});
      }
      (*layer).*place = k;
    }
  }
  return layers;
}

}  // namespace

std::vector<std::string> light_layer_names(const formats::Reader& reader) {
  std::vector<std::string> names;
  for (const LightLayer& layer : all_layers(reader)) names.push_back(layer.name);
  return names;
}

std::vector<LightLayer> light_layers(const formats::Reader& reader,
                                     const std::optional<std::vector<std::string>>& names) {
  const std::vector<LightLayer> all = all_layers(reader);
  std::vector<LightLayer> chosen;
  for (const std::string& name : names ? *names : light_layer_names(reader)) {
    const auto found = find_layer(all, name);
    if (found == all.end()) {
      refuse_layer(
          reader,
          fmt::format("has no layer {} of the light; there are {}", name,
                      all.empty() ? "none"
                                  : fmt::format("{}", fmt::join(light_layer_names(reader), ", "))));
    }
    check_layer(reader, *found);
    chosen.push_back(*found);
  }
  return chosen;
}

}  // namespace psf::run
