#include "film/exr_layers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>

#include "core/error.h"
#include "core/lower.h"

namespace psf::film {
namespace {

// The channels of one prefix, by what follows it, in lower case.
using Group = std::map<std::string, std::string>;

// As it stands in the file; empty where there is none.
std::string find(const Group& group, const std::string& component) {
  const auto found = group.find(component);
  return found == group.end() ? "" : found->second;
}
std::string find(const Group& group, const std::string& component, const std::string& word) {
  const std::string channel = find(group, component);
  return channel.empty() ? find(group, word) : channel;
}

// Whether the layer's channels are named as OpenEXR wants them, which reads chroma by these alone.
bool has_names(const ExrLayer& layer, const std::vector<std::string>& names) {
  const std::string before = layer.prefix.empty() ? "" : layer.prefix + ".";
  return std::equal(names.begin(), names.end(), layer.channels,
                    [&](const std::string& name, const std::string& channel) {
                      return channel == before + name;
                    });
}

std::optional<ExrLayer> layer_of(const Group& group, const std::string& prefix) {
  const auto all = [&](LayerKind kind, const std::string& a, const std::string& b,
                       const std::string& c) -> std::optional<ExrLayer> {
    if (a.empty() || b.empty() || c.empty()) return std::nullopt;
    ExrLayer layer;
    layer.kind = kind;
    layer.prefix = prefix;
    layer.channels[0] = a;
    layer.channels[1] = b;
    layer.channels[2] = c;
    layer.alpha = find(group, "a", "alpha");
    return layer;
  };
  std::optional<ExrLayer> layer = all(LayerKind::color, find(group, "r", "red"),
                                      find(group, "g", "green"), find(group, "b", "blue"));
  if (!layer) {
    layer = all(LayerKind::chroma, find(group, "y"), find(group, "ry"), find(group, "by"));
    if (layer && !has_names(*layer, {"Y", "RY", "BY"})) return std::nullopt;
  }
  if (!layer) layer = all(LayerKind::vector, find(group, "x"), find(group, "y"), find(group, "z"));
  if (!layer && !find(group, "y").empty()) {
    layer.emplace();
    layer->kind = LayerKind::grey;
    layer->prefix = prefix;
    layer->channels[0] = find(group, "y");
    layer->alpha = find(group, "a", "alpha");
  }
  return layer;
}

}  // namespace

std::vector<ExrLayer> exr_layers(const std::vector<ExrPart>& parts) {
  std::vector<ExrLayer> layers;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    std::map<std::string, Group> groups;
    for (const std::string& channel : parts[part].channels) {
      const std::size_t dot = channel.rfind('.');
      const bool prefixed = dot != std::string::npos;
      groups[prefixed ? channel.substr(0, dot) : ""].emplace(
          core::lower(channel.substr(prefixed ? dot + 1 : 0)), channel);
    }
    for (const auto& [prefix, group] : groups) {
      std::optional<ExrLayer> layer = layer_of(group, prefix);
      if (!layer) continue;
      layer->part = part;
      layer->name = prefix.empty() && parts.size() > 1 ? parts[part].name : prefix;
      layers.push_back(*layer);
    }
  }
  std::map<std::string, std::size_t> count;
  for (const ExrLayer& layer : layers) ++count[layer.name];
  for (ExrLayer& layer : layers) {
    if (count[layer.name] > 1 && !layer.prefix.empty()) {
      layer.name = parts[layer.part].name + "." + layer.name;
    }
  }
  return layers;
}

ExrLayer choose_layer(const std::string& path, const std::vector<ExrLayer>& layers,
                      std::string name, const std::string& fallback, const std::string& option) {
  const auto names = [&](auto&& wanted) {
    std::vector<std::string> list;
    for (const ExrLayer& layer : layers) {
      if (wanted(layer)) list.push_back(layer.name.empty() ? "(without a name)" : layer.name);
    }
    return list;
  };
  const auto named = [&](std::string wanted) -> const ExrLayer* {
    if (wanted.ends_with('.')) wanted.pop_back();
    const auto found = std::find_if(layers.begin(), layers.end(),
                                    [&](const ExrLayer& layer) { return layer.name == wanted; });
    return found == layers.end() ? nullptr : &*found;
  };
  if (!name.empty()) {
    if (const ExrLayer* layer = named(name)) return *layer;
    const auto list = names([](const ExrLayer&) { return true; });
    throw Error(ErrorCode::bad_input,
                list.empty() ? fmt::format("{}: has no layer {}, nor any other", path, name)
                             : fmt::format("{}: has no layer {}; its layers: {}", path, name,
                                           fmt::join(list, ", ")));
  }
  const auto colored = [](const ExrLayer& layer) {
    return layer.kind == LayerKind::color || layer.kind == LayerKind::chroma;
  };
  const auto grey = [](const ExrLayer& layer) { return layer.kind == LayerKind::grey; };
  for (const bool in_color : {true, false}) {
    std::vector<const ExrLayer*> fit;
    for (const ExrLayer& layer : layers) {
      if (in_color ? !colored(layer) : !grey(layer)) continue;
      if (layer.name.empty()) return layer;
      fit.push_back(&layer);
    }
    if (fit.size() == 1) return *fit.front();
    if (fit.empty()) continue;
    if (const ExrLayer* layer = fallback.empty() ? nullptr : named(fallback)) return *layer;
    throw Error(ErrorCode::usage,
                fmt::format("{}: has several layers that would do; give {} one of: {}", path,
                            option, fmt::join(in_color ? names(colored) : names(grey), ", ")));
  }
  throw Error(ErrorCode::bad_input, path + ": has no channels R, G, B, nor Y");
}

}  // namespace psf::film
