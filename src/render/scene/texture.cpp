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

bool Texture::grey() const {
  double sum = 0;
  for (std::size_t i = 0; i < width_ * height_; ++i) {
    const Rgb c = texel(i % width_, i / width_);
    sum += double{std::abs(c.x - c.z)};
  }
  constexpr double kMostColour = 0.05;  // lossy formats add a little; the blue of flat is 0.5 above
  return sum < kMostColour * static_cast<double>(width_ * height_);
}

Texture Texture::normals_of_heights() const {
  std::vector<Rgb> normals(width_ * height_);
  const auto height = [&](std::size_t x, std::size_t y) {
    const Rgb c = texel(x % width_, y % height_);
    return (c.x + c.y + c.z) * (1.0f / 3);
  };
  for (std::size_t y = 0; y < height_; ++y) {
    for (std::size_t x = 0; x < width_; ++x) {
      const float by_u = 0.5f * (height(x + 1, y) - height(x + width_ - 1, y));
      const float by_v = 0.5f * (height(x, y + height_ - 1) - height(x, y + 1));
      const Vec3 n = Vec3(-by_u, -by_v, 1).normalized();
      normals[y * width_ + x] = Rgb(0.5f * n.x + 0.5f, 0.5f * n.y + 0.5f, 0.5f * n.z + 0.5f);
    }
  }
  return {width_, height_, std::move(normals)};
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
