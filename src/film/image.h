// A picture with named float channels and attributes, and its files: EXR with everything, PNG to
// look at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/vec.h"

namespace psf::film {

struct Layer {
  std::string channel;        // "R", "unfiltered-input.G", "neighbors.Y"
  std::vector<float> values;  // (height, width), row 0 at the top
};

struct Image {
  std::string path;  // where it was read from, for messages
  std::size_t width = 0, height = 0;
  std::vector<Layer> layers;
  std::vector<std::pair<std::string, std::string>> attributes;  // written as strings, in this order

  // Adds channels prefix + suffix[k] (suffixes "RGB" or "XYZ" or "Y") from (height, width, suffix
  // count) values.
  void add(const std::string& prefix, const std::string& suffixes, std::span<const float> values);
  [[nodiscard]] const std::vector<float>* find(const std::string& channel) const;
  // The colours of `prefix`R, G, B as (height, width); throws Error{bad_input} naming file and
  // channel.
  [[nodiscard]] std::vector<Rgb> rgb(const std::string& prefix = "") const;
};

// Single-part scanline float32 EXR, ZIP compressed on all threads: the same bytes for any number of
// them. Throws Error{io}. The caller names a path whose folder exists; the file appears whole or
// not at all.
void write_exr(const std::string& path, const Image& image);
// Reads every channel of an EXR as write_exr() makes them, as float. Throws what check_part()
// throws and Error{bad_input}. Those of other programs are read by read_picture().
[[nodiscard]] Image read_exr(const std::string& path);

// 8-bit PNG of R, G, B: times 2^exposure, the tone curve of display.h, sRGB transfer.
void write_png(const std::string& path, const Image& image, float exposure = 0);
// The same of (height, width, 3) sRGB values as they are. Throws Error{io}.
void write_png_bytes(const std::string& path, std::size_t width, std::size_t height,
                     std::span<const std::uint8_t> bytes);

// By extension: .exr or .png; anything else throws Error{usage}.
void write_image(const std::string& path, const Image& image);
// Throws what write_image(path, ...) would throw for its name or folder, before any work is done.
void check_image_path(const std::string& path);

}  // namespace psf::film
