#include "render/job/option_text.h"

namespace psf::render {

using core::parse_number;

std::optional<Vec3> parse_colour(std::string_view text) {
  const auto grey = parse_number<float>(text);
  auto colour = grey ? std::optional(Vec3(*grey)) : parse_triple<float>(text);
  if (!colour || !(colour->x >= 0 && colour->y >= 0 && colour->z >= 0)) return std::nullopt;
  return colour;
}

bool parse_size(const std::string& text, std::optional<Vec2>& size) {
  const std::size_t x = text.find('x');
  if (x == std::string::npos) return false;
  const auto width = parse_number<std::uint16_t>(std::string_view(text).substr(0, x));
  const auto height = parse_number<std::uint16_t>(std::string_view(text).substr(x + 1));
  if (!width || !height || *width == 0 || *height == 0) return false;
  size.emplace(static_cast<float>(*width), static_cast<float>(*height));
  return true;
}

bool parse_frames(const std::string& text, std::optional<FrameRange>& frames) {
  const std::size_t colon = text.find(':');
  const auto first = parse_number<std::uint32_t>(std::string_view(text).substr(0, colon));
  if (!first || *first >= kMostFrames) return false;
  auto last = std::optional(*first + 1);
  if (colon != std::string::npos) {
    last = parse_number<std::uint32_t>(std::string_view(text).substr(colon + 1));
  }
  if (!last || *last <= *first || *last > kMostFrames) return false;
  frames = FrameRange{*first, *last - *first};
  return true;
}

bool parse_shutter(const std::string& text, std::optional<Shutter>& shutter) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return false;
  const auto open = parse_number<float>(std::string_view(text).substr(0, colon));
  const auto close = parse_number<float>(std::string_view(text).substr(colon + 1));
  if (!open || !close || !(*open >= -1 && *close <= 1 && *open <= *close)) return false;
  shutter = Shutter{*open, *close};
  return true;
}

bool parse_shade_rate(const std::string& text, std::uint32_t& rate) {
  if (text == "1") return rate = 1, true;
  if (!text.starts_with("1/")) return false;
  const auto k = parse_number<std::uint32_t>(std::string_view(text).substr(2));
  if (!k || *k == 0 || *k > kMostShadeRate) return false;
  rate = *k;
  return true;
}

bool parse_sky(const std::string& text, SceneOverrides& overrides) {
  if (const auto colour = parse_colour(text)) {
    overrides.sky.emplace(colour->x, colour->y, colour->z);
    return true;
  }
  if (text.find_first_not_of("0123456789.,+- ") == std::string::npos) return false;
  overrides.sky_map = text;
  return true;
}

}  // namespace psf::render
