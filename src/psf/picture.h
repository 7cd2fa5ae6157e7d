// Pictures in memory and in files, and the error of one against another.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "psf/export.h"

namespace psf {

// A channel of an EXR: one value a pixel.
struct Layer {
  std::string name;           // "R", "unfiltered-input.G", "neighbors.Y"
  std::vector<float> values;  // (height, width), row 0 at the top
};

// A picture of one camera. It owns its layers and may be copied and changed.
struct PSF_API Picture {
  std::size_t width = 0;      // pixels
  std::size_t height = 0;     // pixels
  std::string camera;         // name; empty where there is none
  std::string file;           // that it was read from; empty where it was made
  std::vector<Layer> layers;  // as in its EXR
  std::vector<std::pair<std::string, std::string>> attributes;  // of its EXR, name and text

  // The values of a layer. Throws Error{bad_input} where there is none of this name.
  [[nodiscard]] const std::vector<float>& layer(std::string_view name) const;
  // The colours of the layers R, G and B behind `prefix`, (height, width, 3), linear. Where a dump
  // has alpha they are premultiplied by the layer A, and its background is apart, behind
  // prefix + "background.". Throws Error{bad_input} where they are not there.
  [[nodiscard]] std::vector<float> rgb(const std::string& prefix = "") const;
  // The bytes of a PNG to look at: times 2^exposure, tone-mapped; those of save() at exposure 0. A
  // background that is kept apart is in it.
  [[nodiscard]] std::vector<unsigned char> png(float exposure = 0) const;

  // The names of the layers of the light; none where it has none, as what read() gives.
  [[nodiscard]] std::vector<std::string> light_layers() const;
  // What psf relight does: each layer of the light that is named times its weight by colour, and
  // R, G, B with it. Throws Error{bad_input} where there are no such layers, Error{usage} for a
  // name that is none of them or a weight that is not finite.
  [[nodiscard]] Picture relight(const std::map<std::string, std::array<float, 3>>& weights) const;

  // Writes an EXR with all layers and attributes, or a PNG to look at, by the extension. The file
  // appears whole or not at all. Throws Error{io}, Error{usage} for another extension.
  void save(const std::string& path) const;
  // Reads the colours of an EXR, with a background that is kept apart from them: its root or the
  // layer of this name. Throws Error{io}, Error{bad_input}.
  [[nodiscard]] static Picture read(const std::string& path, const std::string& layer = "");

  // The error against a reference of the same size by a metric of metric_names(), upper or lower
  // case, as psf compare gives it: with the background that either keeps apart. Throws
  // Error{usage}, Error{bad_input} for another size.
  [[nodiscard]] double error(const Picture& reference, std::string_view metric = "relMSE") const;
};

// The metrics that error() and Dump::sweep() know.
[[nodiscard]] PSF_API std::vector<std::string> metric_names();

}  // namespace psf
