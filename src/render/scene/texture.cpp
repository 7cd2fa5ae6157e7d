#include "render/scene/texture.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace psf::render {
namespace {

struct Wrapped {
  std::size_t first, second;
  float weight;  // weight of `second`
};

// The two texels around `coordinate`, whose picture repeats after 1 and has `size` texels.
Wrapped wrap(float coordinate, std::size_t size) {
  float part = coordinate - std::floor(coordinate);
  if (!(part >= 0 && part <= 1)) part = 0;  // not finite
  const float position = part * static_cast<float>(size) - 0.5f;
  if (position < 0) return {size - 1, 0, position + 1};
  const std::size_t first = std::min(static_cast<std::size_t>(position), size - 1);
  const std::size_t second = first + 1 < size ? first + 1 : 0;
  return {first, second, position - static_cast<float>(first)};
}

}  // namespace

Texture::Texture(std::size_t width, std::size_t height, std::vector<Rgb> texels)
    : width_(width), height_(height), texels_(std::move(texels)) {
  if (width == 0 || height == 0 || texels_.size() != width * height) {
    throw Error(ErrorCode::bad_input,
                fmt::format("a texture of {} x {} texels needs {}, got {}", width, height,
                            std::max<std::size_t>(1, width * height), texels_.size()));
  }
}

Rgb Texture::at(const Vec2& uv) const {
  const Wrapped x = wrap(uv.x, width_);
  const Wrapped y = wrap(1 - uv.y, height_);
  const Rgb top = texel(x.first, y.first) * (1 - x.weight) + texel(x.second, y.first) * x.weight;
  const Rgb bottom =
      texel(x.first, y.second) * (1 - x.weight) + texel(x.second, y.second) * x.weight;
  return top * (1 - y.weight) + bottom * y.weight;
}

}  // namespace psf::render
