// Which channels of an EXR make up a picture, whatever program wrote it.
#pragma once

#include <string>
#include <vector>

namespace psf::film {

// One part of a file: its name, empty where there is but one part, and its channels.
struct ExrPart {
  std::string name;
  std::vector<std::string> channels;
};

enum class LayerKind {
  color,   // R, G, B
  chroma,  // Y, RY, BY: luminance and chroma, for colours
  grey,    // Y alone
  vector,  // X, Y, Z, taken for R, G, B
};

struct ExrLayer {
  std::string name;  // what the user calls it: "", "beauty", "ViewLayer.Combined"
  LayerKind kind = LayerKind::color;
  std::size_t part = 0;
  std::string prefix;       // of the channels, without dot
  std::string channels[3];  // one alone of grey, luminance first of chroma
  std::string alpha;        // empty: none
};

// Channels that differ in what follows the last dot of their names are a layer: R, G, B in either
// case, or red, green, blue; else Y, RY, BY in capitals (in another case they are no layer at all,
// as their Y is no grey); else X, Y, Z; else Y. Where a file has several parts, a layer without
// prefix bears its part's name, and one whose prefix is in several parts both names.
[[nodiscard]] std::vector<ExrLayer> exr_layers(const std::vector<ExrPart>& parts);

// The layer `name`, with or without a dot behind; where that is empty, the colours at the root, or
// the only ones there are, or the only grey. `fallback` is a name that is taken where several would
// do. Throws Error{usage} where several would do, with their names and `option`, by which one is
// named; Error{bad_input} where there is none.
[[nodiscard]] ExrLayer choose_layer(const std::string& path, const std::vector<ExrLayer>& layers,
                                    std::string name, const std::string& fallback,
                                    const std::string& option);

}  // namespace psf::film
