// What the texts of psf-render's options become.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/number.h"
#include "core/vec.h"
#include "render/job/job.h"

namespace psf::render {

constexpr std::uint32_t kMostFrames = 1u << 24;

// "1,2,3"
template <class T>
[[nodiscard]] std::optional<Imath::Vec3<T>> parse_triple(std::string_view text) {
  Imath::Vec3<T> result;
  for (int k = 0; k < 3; ++k) {
    const std::size_t end = k < 2 ? text.find(',') : text.size();
    if (end == std::string_view::npos) return std::nullopt;
    const auto number = core::parse_number<T>(text.substr(0, end));
    if (!number) return std::nullopt;
    result[k] = *number;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

// "1,2,3", or one number for grey, of at least 0.
[[nodiscard]] std::optional<Vec3> parse_colour(std::string_view text);
// These set the target, or return false where the text is none for it.
[[nodiscard]] bool parse_size(const std::string& text, std::optional<Vec2>& size);
// FIRST:LAST, or one frame.
[[nodiscard]] bool parse_frames(const std::string& text, std::optional<FrameRange>& frames);
// OPEN:CLOSE
[[nodiscard]] bool parse_shutter(const std::string& text, std::optional<Shutter>& shutter);
[[nodiscard]] bool parse_shade_rate(const std::string& text, std::uint32_t& rate);
// A colour, or else the name of a picture; text made of numbers alone is never taken for a name.
[[nodiscard]] bool parse_sky(const std::string& text, SceneOverrides& overrides);

}  // namespace psf::render
