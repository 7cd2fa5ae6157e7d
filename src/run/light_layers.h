// The layers of the light that a dump has: named parts of c and u, which add up to them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "formats/read/reader.h"

namespace psf::run {

// The layer NAME of the channels contribution.NAME and unfiltered.NAME; their places in the file.
// At least one is there.
struct LightLayer {
  std::string name;
  std::optional<std::size_t> contribution, unfiltered;
};

// The names of the layers of a file, in the order of its channels, whatever they are.
[[nodiscard]] std::vector<std::string> light_layer_names(const formats::Reader& reader);

// The layers of a file, in the order of its channels; with `names`, those of these names, in their
// order. Throws Error{bad_input} for a name that there is not, for a channel that is not three
// numbers of floating point, and for a layer that pictures cannot have (film::why_no_layer_name()).
[[nodiscard]] std::vector<LightLayer> light_layers(
    const formats::Reader& reader, const std::optional<std::vector<std::string>>& names = {});

}  // namespace psf::run
