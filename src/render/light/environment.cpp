// Light from infinity: lookup and sampling of the map.
#include "render/light/environment.h"

#include "core/parallel.h"
#include "render/light/frame.h"
#include "render/light/surface.h"

namespace psf::render {

EnvironmentLight::EnvironmentLight(const Scene& scene) : scale_(scene.environment.radiance) {
  power_ = 4 * kPi * luminance(scale_);
  if (scene.environment.texture == kNone || is_black(scale_)) return;
  const Texture& map = scene.textures[static_cast<std::size_t>(scene.environment.texture)];
  cosine_ = std::cos(scene.environment.rotation);
  sine_ = std::sin(scene.environment.rotation);
  const std::size_t width = map.width(), height = map.height();
  heights_.resize(height + 1);
  for (std::size_t y = 0; y <= height; ++y) {
    heights_[y] = static_cast<float>(
        std::cos(std::numbers::pi * static_cast<double>(y) / static_cast<double>(height)));
  }
  columns_.resize(height);
  std::vector<float> row_weights(height);
  core::parallel_for(height, 16, [&](std::size_t begin, std::size_t end) {
    std::vector<float> smooth(width), weights(width);
    for (std::size_t y = begin; y < end; ++y) {
      // The integral of the bilinear interpolation over each texel: 1/8, 6/8, 1/8 in both
      // directions. It is positive wherever the lookup is.
      const std::size_t above = y == 0 ? 0 : y - 1, below = std::min(y + 1, height - 1);
      for (std::size_t x = 0; x < width; ++x) {
        smooth[x] = 0.125f * luminance(map.texel(x, above)) + 0.75f * luminance(map.texel(x, y)) +
                    0.125f * luminance(map.texel(x, below));
      }
      for (std::size_t x = 0; x < width; ++x) {
        weights[x] = 0.125f * smooth[(x + width - 1) % width] + 0.75f * smooth[x] +
                     0.125f * smooth[(x + 1) % width];
      }
      columns_[y] = Distribution(weights);
      row_weights[y] = static_cast<float>(columns_[y].total()) * (heights_[y] - heights_[y + 1]);
    }
  });
  rows_ = Distribution(row_weights);
  map_ = &map;
  power_ =
      static_cast<float>(rows_.total()) * 2 * kPi / static_cast<float>(width) * luminance(scale_);
  if (!(power_ > 0)) scale_ = Rgb(0, 0, 0), map_ = nullptr;
}

Vec3 EnvironmentLight::to_map(const Vec3& v) const {
  return {cosine_ * v.x - sine_ * v.z, v.y, sine_ * v.x + cosine_ * v.z};
}

Vec3 EnvironmentLight::from_map(const Vec3& v) const {
  return {cosine_ * v.x + sine_ * v.z, v.y, cosine_ * v.z - sine_ * v.x};
}

Rgb EnvironmentLight::radiance(const Vec3& direction) const {
  if (map_ == nullptr) return scale_;
  Vec2 uv = direction_to_uv(to_map(direction));
  const float edge = 0.5f / static_cast<float>(map_->height());
  uv.y = std::clamp(uv.y, edge, 1 - edge);
  return scale_ * map_->at(uv);
}

float EnvironmentLight::texel_pdf(std::size_t x, std::size_t y) const {
  const float solid_angle =
      2 * kPi / static_cast<float>(map_->width()) * (heights_[y] - heights_[y + 1]);
  return rows_.probability(y) * columns_[y].probability(x) / solid_angle;
}

Vec3 EnvironmentLight::sample(Vec2 u, float& pdf) const {
  if (map_ == nullptr) {
    pdf = 0.25f * kInvPi;
    return uniform_sphere(u);
  }
  const std::size_t y = rows_.sample(u.y), x = columns_[y].sample(u.x);
  pdf = texel_pdf(x, y);
  const float height = heights_[y] + (heights_[y + 1] - heights_[y]) * u.y;
  const float longitude =
      ((static_cast<float>(x) + u.x) / static_cast<float>(map_->width()) - 0.5f) * 2 * kPi;
  const float r = std::sqrt(std::max(0.0f, 1 - height * height));
  return from_map({r * std::sin(longitude), height, -r * std::cos(longitude)});
}

float EnvironmentLight::pdf(const Vec3& direction) const {
  const Vec3 local = to_map(direction);
  const Vec2 uv = direction_to_uv(local);
  const auto width = map_->width(), height = map_->height();
  const auto x = static_cast<std::size_t>(std::max(0.0f, uv.x * static_cast<float>(width)));
  const auto y = static_cast<std::size_t>(std::max(0.0f, (1 - uv.y) * static_cast<float>(height)));
  return texel_pdf(std::min(x, width - 1), std::min(y, height - 1));
}

}  // namespace psf::render
