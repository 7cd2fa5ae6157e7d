// Weighs the layers of the light of a picture: a picture is linear in its lights.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/vec.h"
#include "film/image.h"

namespace psf::film {

// The attribute that lists the layers of the light of a picture, with commas between: NAME.R/G/B,
// which add up to R, G, B.
inline constexpr const char* kLightLayers = "psf:light-layers";

// The names of these layers; none where the picture has no such attribute.
[[nodiscard]] std::vector<std::string> light_layers_of(const Image& image);

// By layer: what its light is multiplied with, by colour.
using LightWeights = std::map<std::string, Rgb>;

// The picture with R, G, B the weighted sum of the layers, which are multiplied too, so that the
// result is such a picture again; so is what it has of them in unfiltered-input, where that has the
// layers. Other channels stay. Layers that `weights` does not name keep their light. The attribute
// psf:relight says the weights, after those of the relights before; attributes are in order. Throws Error{bad_input} naming
// the file where it has no layers of the light or a channel of one is missing, and Error{usage} for
// a layer that is none of them.
[[nodiscard]] Image relight(const Image& image, const LightWeights& weights);

}  // namespace psf::film
