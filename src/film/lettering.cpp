#include "film/lettering.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/vec.h"
#include "film/glyphs.h"

namespace psf::film {
namespace {

// In the units of the glyphs.
constexpr float kCapital = 14, kPen = 1.75f, kGap = 4.5f, kSpace = 3;

using Line = std::vector<Vec2>;

std::string_view glyph_of(char letter) {
  const std::size_t place = static_cast<unsigned char>(letter) - std::size_t{kFirstGlyph};
  return kGlyphs[place < kGlyphs.size() ? place : std::size_t{'?' - kFirstGlyph}];
}

// Whether a byte goes on with a letter of several bytes of UTF-8.
bool goes_on(char byte) {
  return (static_cast<unsigned char>(byte) & 0xc0u) == 0x80u;
}

float coordinate(char digit) {
  return static_cast<float>(digit <= '9' ? digit - '0' : digit - 'a' + 10);
}

// The B-spline of `points`: an arc of a parabola around each point but the first and the last.
Line smooth(const Line& points) {
  constexpr int kPieces = 8;
  Line line = {points.front()};
  for (std::size_t k = 1; k + 1 < points.size(); ++k) {
    const Vec2 begin = line.back(), middle = points[k];
    const bool is_last = k + 2 == points.size();
    const Vec2 end = is_last ? points[k + 1] : (middle + points[k + 1]) * 0.5f;
    for (int piece = 1; piece <= kPieces; ++piece) {
      const float t = static_cast<float>(piece) / kPieces, s = 1 - t;
      line.push_back(begin * (s * s) + middle * (2 * s * t) + end * (t * t));
    }
  }
  return line;
}

std::vector<Line> strokes_of(std::string_view glyph) {
  std::vector<Line> strokes;
  while (!glyph.empty()) {
    const std::size_t end = std::min(glyph.find(' '), glyph.size());
    std::string_view stroke = glyph.substr(0, end);
    glyph.remove_prefix(std::min(end + 1, glyph.size()));
    const bool is_smooth = stroke.front() == '~';
    if (is_smooth) stroke.remove_prefix(1);
    Line points;
    for (std::size_t k = 0; k + 1 < stroke.size(); k += 2) {
      points.emplace_back(coordinate(stroke[k]), coordinate(stroke[k + 1]));
    }
    strokes.push_back(is_smooth ? smooth(points) : points);
  }
  return strokes;
}

// From the first point of a letter to that of the next.
float advance_of(std::string_view glyph) {
  float right = glyph.empty() ? kSpace : 0;
  for (const Line& line : strokes_of(glyph)) {
    for (const Vec2& point : line) right = std::max(right, point.x);
  }
  return right + kGap;
}

float distance_sq(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const float length = along.length2();
  const float t = length > 0 ? std::clamp((p - a).dot(along) / length, 0.0f, 1.0f) : 0;
  return (p - a - along * t).length2();
}

// Blends the pixels under a pen of this radius that goes along `strokes`, both in pixels.
void draw(Canvas& canvas, const std::vector<Line>& strokes, float pen, const Byte3& color) {
  constexpr float kFar = std::numeric_limits<float>::max();
  Vec2 low(kFar, kFar), high(-kFar, -kFar);
  for (const Line& line : strokes) {
    for (const Vec2& p : line) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  }
  const auto within = [](float value, std::size_t size) {
    return static_cast<std::size_t>(std::clamp(value, 0.0f, static_cast<float>(size)));
  };
  const float reach = pen + 1;
  for (std::size_t y = within(low.y - reach, canvas.height);
       y < within(high.y + reach + 1, canvas.height); ++y) {
    for (std::size_t x = within(low.x - reach, canvas.width);
         x < within(high.x + reach + 1, canvas.width); ++x) {
      const Vec2 p(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      float nearest = kFar;
      for (const Line& line : strokes) {
        for (std::size_t k = 0; k + 1 < line.size(); ++k) {
          nearest = std::min(nearest, distance_sq(p, line[k], line[k + 1]));
        }
      }
      const float covered = std::clamp(pen + 0.5f - std::sqrt(nearest), 0.0f, 1.0f);
      for (std::size_t c = 0; c < 3; ++c) {
        std::uint8_t& value = canvas.values[3 * (y * canvas.width + x) + c];
        const float under = value;
        value = static_cast<std::uint8_t>(std::lround(under + covered * (color[c] - under)));
      }
    }
  }
}

}  // namespace

Canvas::Canvas(std::size_t wide, std::size_t high, const Byte3& color)
    : width(wide), height(high), values(3 * wide * high) {
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = color[k % 3];
}

void Canvas::place(std::size_t x, std::size_t y, std::size_t wide, std::size_t high,
                   const std::uint8_t* from) {
  assert(x + wide <= width && y + high <= height);
  for (std::size_t row = 0; row < high; ++row) {
    std::copy_n(from + 3 * row * wide, 3 * wide, &values[3 * ((y + row) * width + x)]);
  }
}

double text_width(std::string_view text, double size) {
  float units = 0;
  for (const char letter : text) {
    if (!goes_on(letter)) units += advance_of(glyph_of(letter));
  }
  return std::max(0.0, double{units - kGap + kPen}) * size / double{kCapital};
}

void draw_text(Canvas& canvas, double x, double y, std::string_view text, const Lettering& how) {
  const float scale = static_cast<float>(how.size) / kCapital;
  const float pen = std::max(0.5f, scale * kPen / 2);
  Vec2 corner(static_cast<float>(x) + pen, static_cast<float>(y) - pen - kCapital * scale);
  for (const char letter : text) {
    if (goes_on(letter)) continue;
    const std::string_view glyph = glyph_of(letter);
    std::vector<Line> strokes = strokes_of(glyph);
    for (Line& line : strokes) {
      for (Vec2& point : line) point = corner + point * scale;
    }
    draw(canvas, strokes, pen, how.color);
    corner.x += advance_of(glyph) * scale;
  }
}

}  // namespace psf::film
