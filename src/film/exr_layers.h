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
  vector,  // X, Y, Z, read as R, G, B
};

struct ExrLayer {
  std::string name;  // as the user writes it: "", "beauty", "ViewLayer.Combined"
  LayerKind kind = LayerKind::color;
  std::size_t part = 0;
  std::string prefix;       // what the channels' names begin with, without the dot
  std::string channels[3];  // grey: only the first is set; chroma: the first is luminance
  std::string alpha;        // the alpha channel; empty: none
};

// Finds the layers of a file. Channels whose names are equal up to the last dot form a layer where
// they hold R, G, B in either case, or red, green, blue; else Y, RY, BY in capitals (in another
// case they are no layer, since their Y is not a grey picture); else X, Y, Z; else Y. Where a file
// has several parts, a layer without prefix has the name of its part, and a layer whose prefix
// occurs in several parts is named "part.prefix".
[[nodiscard]] std::vector<ExrLayer> exr_layers(const std::vector<ExrPart>& parts);

// The layer called `name`, which may end with a dot. Where `name` is empty: the colours at the
// root, or the only colours there are, or the only grey layer. Where several layers would do, the
// one called `fallback` is taken; without it Error{usage} is thrown, with their names and `option`,
// the option that names a layer. Throws Error{bad_input} where there is no such layer.
[[nodiscard]] ExrLayer choose_layer(const std::string& path, const std::vector<ExrLayer>& layers,
                                    std::string name, const std::string& fallback,
                                    const std::string& option);

}  // namespace psf::film
