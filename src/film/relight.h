// Weighs the layers of the light of a picture: a picture is linear in its lights.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/vec.h"
#include "film/image.h"
#include "film/light_layers.h"

namespace psf::film {

// The names of the layers of the light of a picture; none where it has none.
[[nodiscard]] std::vector<std::string> light_layers_of(const Image& image);

// By layer: what its light is multiplied with, by colour.
using LightWeights = std::map<std::string, Rgb>;

// The picture with the layers times their weights, and R, G, B what their light then is; light that
// is in no layer stays. The result is such a picture again; so is what it has of the layers in
// unfiltered-input. Other channels, and layers that `weights` does not name, stay. The attribute
// psf:relight says the weights, after those of the relights before; attributes are in order. The
// background that a picture keeps apart (light_layers.h) may be weighed by its name, too: it stays
// apart. Throws Error{bad_input} naming the file where it has neither, or a channel of one is
// missing, and Error{usage} for a layer that is none of them or a weight that is not finite.
[[nodiscard]] Image relight(const Image& image, const LightWeights& weights);

}  // namespace psf::film
