#include "run/light_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/error.h"

namespace psf::run {
namespace {

// What pictures have beside the light.
constexpr std::string_view kOtherLayers[] = {"unfiltered-input", "neighbors", "radius", "albedo",
                                             "normal"};

[[noreturn]] void refuse_layer(const formats::Reader& reader, const std::string& why) {
  throw Error(ErrorCode::bad_input, fmt::format("{}: {}", reader.path(), why));
}

void check_layer(const formats::Reader& reader, const formats::Channel& channel,
                 std::string_view layer) {
  using formats::Type;
  const bool is_float =
      channel.type == Type::f16 || channel.type == Type::f32 || channel.type == Type::f64;
  if (!is_float || channel.components != 3) {
    refuse_layer(reader,
                 fmt::format("channel {} is {} x {}, expected f32 x 3: it is a layer of "
                             "the light; see formats/README.md",
                             channel.name, formats::name_of(channel.type), channel.components));
  }
  if (layer.find_first_of(",=") != std::string_view::npos) {
    refuse_layer(reader, fmt::format("channel {}: the name of a layer of the light has no ',' and "
                                     "no '='",
                                     channel.name));
  }
  if (std::find(std::begin(kOtherLayers), std::end(kOtherLayers), layer) !=
      std::end(kOtherLayers)) {
    refuse_layer(reader, fmt::format("channel {}: {} is another layer of pictures; give this part "
                                     "of the light another name",
                                     channel.name, layer));
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
      check_layer(reader, channels[k], name);
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

std::vector<LightLayer> light_layers(const formats::Reader& reader,
                                     const std::optional<std::vector<std::string>>& names) {
  std::vector<LightLayer> all = all_layers(reader);
  if (!names) return all;
  std::vector<LightLayer> chosen;
  for (const std::string& name : *names) {
    const auto found = find_layer(all, name);
    if (found == all.end()) {
      std::string there;
      for (const LightLayer& layer : all) {
        there += (there.empty() ? "there are " : ", ") + layer.name;
      }
      refuse_layer(reader, fmt::format("has no layer {} of the light; {}", name,
                                       there.empty() ? "it has none" : there));
    }
    chosen.push_back(*found);
  }
  return chosen;
}

}  // namespace psf::run
