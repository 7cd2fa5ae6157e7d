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
  std::string path;  // the file that it was read from, for messages
  std::size_t width = 0, height = 0;
  std::vector<Layer> layers;
  std::vector<std::pair<std::string, std::string>> attributes;  // written as strings, in this order

  // Adds the channels prefix + suffixes[k]; suffixes are "RGB", "XYZ" or "Y". `values` are (height,
  // width, number of suffixes).
  void add(const std::string& prefix, const std::string& suffixes, std::span<const float> values);
  [[nodiscard]] const std::vector<float>* find(const std::string& channel) const;
  // The colours of the channels R, G and B behind `prefix`, (height, width). Throws
  // Error{bad_input} naming the file and the channel where one is missing.
  [[nodiscard]] std::vector<Rgb> rgb(const std::string& prefix = "") const;
  // Whether the background of the colours behind `prefix` is kept apart from them (kBackgroundIs),
  // as the layer `background` behind it.
  [[nodiscard]] bool has_background(const std::string& prefix = "") const;
  // These colours with their background where it is kept apart: what a picture without alpha has.
  [[nodiscard]] std::vector<Rgb> seen(const std::string& prefix = "") const;
};

// Writes an EXR of one part: scan lines of float32, ZIP compressed on all threads. The bytes are
// the same for any number of threads. The folder must exist; the file appears whole or not at all.
// Throws Error{io}.
void write_exr(const std::string& path, const Image& image);
// Reads every channel, as float, of an EXR such as write_exr() makes; read_picture() reads EXRs of
// other programs. Throws what check_part() throws and Error{bad_input}.
[[nodiscard]] Image read_exr(const std::string& path);

// Writes the channels R, G and B, with the background that is kept apart from them, as an 8-bit PNG:
// times 2^exposure, through tone_map() and srgb_from_linear() of display.h.
void write_png(const std::string& path, const Image& image, float exposure = 0);
// The bytes of the file that write_png() writes.
[[nodiscard]] std::vector<std::uint8_t> encode_png(const Image& image, float exposure = 0);
// The bytes of an 8-bit PNG of (height, width, 3) sRGB values.
[[nodiscard]] std::vector<std::uint8_t> encode_png_bytes(std::size_t width, std::size_t height,
                                                         std::span<const std::uint8_t> bytes);
// Writes (height, width, 3) sRGB values as an 8-bit PNG. Throws Error{io}.
void write_png_bytes(const std::string& path, std::size_t width, std::size_t height,
                     std::span<const std::uint8_t> bytes);

// Writes an EXR or a PNG, by the extension .exr or .png; any other throws Error{usage}.
void write_image(const std::string& path, const Image& image);
// Throws what write_image(path, ...) would throw for its name or folder, before any work is done.
void check_image_path(const std::string& path);

}  // namespace psf::film
