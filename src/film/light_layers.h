// What layers of the light are called in a picture, and what they may be called.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace psf::film {

// The attribute that lists the layers of the light that a picture has, with commas between. Layer
// NAME is the channels NAME.R/G/B; what the same paths are without filter is UNFILTERED.NAME.R/G/B.
inline constexpr const char* kLightLayers = "psf:light-layers";
inline constexpr const char* kUnfiltered = "unfiltered-input";

// The layer of the light of the background, and the attribute of a picture that keeps it apart: its
// R, G, B are premultiplied by its A and lack the background, which Image::seen() adds.
inline constexpr const char* kBackground = "background";
inline constexpr const char* kBackgroundIs = "psf:background";
inline constexpr const char* kApart = "apart";

// The other layers of a picture of psf filter; `alpha` is A and the background.
inline constexpr std::array<std::string_view, 7> kOtherLayers = {
    kUnfiltered, "neighbors", "radius", "albedo", "normal", "alpha", "fireflies"};

// Why a layer of the light cannot have this name; empty where it can. Lists of layers have commas,
// weights an equals sign, and `all` and `none` are lists.
[[nodiscard]] inline std::string why_no_layer_name(std::string_view name) {
  const std::string text(name);
  if (name.empty()) return "a layer has a name";
  if (name.find_first_of(",=") != std::string_view::npos) {
    return "the name of a layer of the light has no ',' and no '='";
  }
  if (name == "all" || name == "none") return text + " stands for layers, and is none";
  const bool taken =
      std::find(kOtherLayers.begin(), kOtherLayers.end(), name) != kOtherLayers.end();
  if (taken || name.starts_with(std::string(kUnfiltered) + ".")) {
    return text + " is another layer of pictures";
  }
  return "";
}

}  // namespace psf::film
