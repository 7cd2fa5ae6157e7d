#include "film/image.h"

#include <algorithm>
#include <cassert>
#include <filesystem>

#include "core/error.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "film/light_layers.h"

namespace psf::film {

void Image::add(const std::string& prefix, const std::string& suffixes,
                std::span<const float> values) {
  assert(values.size() == width * height * suffixes.size());
  const std::size_t first = layers.size(), count = suffixes.size();
  layers.resize(first + count);
  core::parallel_for(count, 1, [&](std::size_t k, std::size_t) {
    layers[first + k] = {prefix + suffixes[k], std::vector<float>(width * height)};
    for (std::size_t pixel = 0; pixel < width * height; ++pixel) {
      layers[first + k].values[pixel] = values[pixel * count + k];
    }
  });
}

const std::vector<float>* Image::find(const std::string& channel) const {
  for (const Layer& layer : layers) {
    if (layer.channel == channel) return &layer.values;
  }
  return nullptr;
}

std::vector<Rgb> Image::rgb(const std::string& prefix) const {
  const std::vector<float>* planes[3];
  for (int k = 0; k < 3; ++k) {
    const std::string channel = prefix + "RGB"[k];
    planes[k] = find(channel);
    if (planes[k] == nullptr) {
      throw Error(ErrorCode::bad_input, path + ": has no channel " + channel);
    }
  }
  std::vector<Rgb> result(width * height);
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = Rgb((*planes[0])[i], (*planes[1])[i], (*planes[2])[i]);
  }
  return result;
}

bool Image::has_background(const std::string& prefix) const {
  const auto is_apart = [](const auto& attribute) {
    return attribute.first == kBackgroundIs && attribute.second == kApart;
  };
  return std::any_of(attributes.begin(), attributes.end(), is_apart) &&
         find(prefix + kBackground + ".R") != nullptr;
}

std::vector<Rgb> Image::seen(const std::string& prefix) const {
  std::vector<Rgb> colors = rgb(prefix);
  if (!has_background(prefix)) return colors;
  const std::vector<Rgb> background = rgb(prefix + kBackground + ".");
  for (std::size_t i = 0; i < colors.size(); ++i) colors[i] += background[i];
  return colors;
}

void check_image_path(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension != ".exr" && extension != ".png") {
    throw Error(ErrorCode::usage,
                path + ": unknown picture format \"" + extension + "\", use .exr or .png");
  }
  core::OutputFile probe(path);
}

void write_image(const std::string& path, const Image& image) {
  check_image_path(path);
  if (std::filesystem::path(path).extension() == ".exr") {
    write_exr(path, image);
  } else {
    write_png(path, image);
  }
}

}  // namespace psf::film
