// Letters are drawn where they should be, and a sheet shows its pictures as a PNG would, with their
// labels below.
#include "film/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "catch.h"
#include "core/error.h"
#include "film/display.h"
#include "film/lettering.h"

using psf::Rgb;
using psf::film::Byte3;
using psf::film::Canvas;
using psf::film::ContactSheet;
using psf::film::draw_text;
using psf::film::text_width;

namespace {

constexpr Byte3 kBlack = {0, 0, 0}, kWhite = {255, 255, 255};

struct Box {
  std::size_t left, top, right, bottom;  // of what is not `paper`; the last ones are not in it
};

Byte3 color_at(const Canvas& canvas, std::size_t x, std::size_t y) {
  const std::uint8_t* p = &canvas.values[3 * (y * canvas.width + x)];
  return {p[0], p[1], p[2]};
}

Box ink(const Canvas& canvas, const Byte3& paper) {
  Box box = {canvas.width, canvas.height, 0, 0};
  for (std::size_t y = 0; y < canvas.height; ++y) {
    for (std::size_t x = 0; x < canvas.width; ++x) {
      if (color_at(canvas, x, y) == paper) continue;
      box.left = std::min(box.left, x);
      box.top = std::min(box.top, y);
      box.right = std::max(box.right, x + 1);
      box.bottom = std::max(box.bottom, y + 1);
    }
  }
  return box;
}

Canvas written(const std::string& text, double size) {
  Canvas canvas(static_cast<std::size_t>(text_width(text, size)) + 40, 80, kBlack);
  draw_text(canvas, 20, 50, text, {size, kWhite});
  return canvas;
}

// A sheet of one picture of one color.
Canvas sheet_of(const std::string& label, const std::string& detail) {
  ContactSheet sheet(256, 64, {});
  sheet.add_section("");
  sheet.add(std::vector<Rgb>(256 * 64, Rgb(0.2f, 0.4f, 0.1f)), label, detail);
  return sheet.draw();
}

// The first and the last row that differ, and the first and the last column.
Box difference(const Canvas& a, const Canvas& b) {
  REQUIRE(a.width == b.width);
  REQUIRE(a.height == b.height);
  Canvas apart(a.width, a.height, kBlack);
  for (std::size_t k = 0; k < a.values.size(); ++k) {
    apart.values[k] = a.values[k] == b.values[k] ? 0 : 255;
  }
  return ink(apart, kBlack);
}

}  // namespace

TEST_CASE("Every printable letter has a shape of its own") {
  std::set<std::vector<std::uint8_t>> shapes;
  for (char letter = '!'; letter <= '~'; ++letter) {
    Canvas canvas(80, 80, kBlack);
    draw_text(canvas, 20, 50, std::string(1, letter), {28, kWhite});
    INFO(letter);
    CHECK(ink(canvas, kBlack).left < canvas.width);
    CHECK(shapes.insert(canvas.values).second);
  }
  CHECK(shapes.size() == 94);
}

TEST_CASE("Text begins at x, stands on y, is as high as asked for and as wide as said") {
  for (const double size : {9.0, 14.0, 28.0}) {
    INFO(size);
    const Canvas canvas = written("HEH", size);
    const Box box = ink(canvas, kBlack);
    CHECK(box.left == 20);
    CHECK(std::abs(static_cast<double>(box.right - box.left) - text_width("HEH", size)) <= 1.5);
    CHECK(std::abs(static_cast<double>(box.bottom) - 50) <= 1);
    CHECK(std::abs(static_cast<double>(box.bottom - box.top) - size * 15.75 / 14) <= 1.5);
    CHECK(ink(written("Hg", size), kBlack).bottom > box.bottom);  // below the line
  }
  CHECK(text_width("", 14) == 0);
  CHECK(text_width("reflectance", 14) < text_width("reflectance 0.05", 14));
  CHECK(text_width("reflectance", 28) == Approx(2 * text_width("reflectance", 14)));
}

TEST_CASE("Text beyond the canvas is cut, and what has no shape is a question mark") {
  Canvas canvas(30, 10, kBlack);
  for (const double x : {-500.0, -3.0, 25.0, 500.0}) {
    for (const double y : {-50.0, 0.0, 8.0, 90.0}) draw_text(canvas, x, y, "gM|", {14, kWhite});
  }
  CHECK(ink(canvas, kBlack).right == 30);
  // A letter of two bytes, one of three, and a byte that is none.
  CHECK(written("caf\xc3\xa9 \xe2\x82\xac\n", 14).values == written("caf? ??", 14).values);
}

TEST_CASE("A sheet shows its pictures as a PNG does, brightened alike") {
  psf::film::SheetOptions options;
  options.exposure = 1;
  ContactSheet sheet(256, 2, options);
  sheet.add_section("one");
  std::vector<Rgb> ramp(512);
  for (std::size_t k = 0; k < ramp.size(); ++k) {
    ramp[k] = Rgb(static_cast<float>(k) / 200, 0.1f, NAN);
  }
  sheet.add(ramp, "", "");
  sheet.add(std::vector<Rgb>(512, Rgb(7, 7, 7)), "", "");
  const Canvas canvas = sheet.draw();
  std::size_t found = 0;
  for (std::size_t y = 0; y + 1 < canvas.height; ++y) {
    for (std::size_t x = 0; x + 256 <= canvas.width; ++x) {
      bool same = true;
      for (std::size_t k = 0; same && k < ramp.size(); ++k) {
        const Byte3 expected = {psf::film::displayed_byte(2 * ramp[k].x),
                                psf::film::displayed_byte(0.2f), 0};
        same = color_at(canvas, x + k % 256, y + k / 256) == expected;
      }
      found += same ? 1u : 0u;
    }
  }
  CHECK(found == 1);
}

TEST_CASE("A label stands below its picture, from its left edge on, and nowhere else") {
  const Canvas nothing = sheet_of("", "x");
  const Box picture = [&] {
    Canvas only = nothing;
    const Byte3 shown = {124, 170, 89};  // sRGB of 0.2, 0.4, 0.1
    for (std::size_t k = 0; k < only.values.size(); k += 3) {
      const bool is_shown = std::equal(shown.begin(), shown.end(), &only.values[k]);
      std::fill_n(&only.values[k], 3, static_cast<std::uint8_t>(is_shown ? 255 : 0));
    }
    return ink(only, kBlack);
  }();
  REQUIRE(picture.right - picture.left == 256);
  REQUIRE(picture.bottom - picture.top == 64);
  CHECK(picture.left == nothing.width - picture.right);  // even margins

  const Box label = difference(nothing, sheet_of("no weights", "x"));
  CHECK(label.top >= picture.bottom + 4);
  CHECK(label.left >= picture.left);
  CHECK(label.left <= picture.left + 3);
  CHECK(label.right < picture.right);
  const Box detail = difference(sheet_of("no weights", "x"), sheet_of("no weights", "relMSE 1"));
  CHECK(detail.top > label.bottom);
  CHECK(detail.bottom < nothing.height - 20);
  CHECK(sheet_of("a", "b").values != sheet_of("b", "a").values);
}

TEST_CASE("Small pictures are enlarged, crops cut, and cells never narrower than their labels") {
  const std::vector<Rgb> grey(64 * 32, Rgb(0.2f, 0.2f, 0.2f));
  const auto size_of = [&](const psf::film::SheetOptions& options, const std::string& label) {
    ContactSheet sheet(64, 32, options);
    sheet.add_section("");
    for (int k = 0; k < 7; ++k) sheet.add(grey, label, "");
    const Canvas canvas = sheet.draw();
    return std::pair(canvas.width, canvas.height);
  };
  psf::film::SheetOptions one, five, crop;
  one.columns = 1;
  crop.columns = 1;
  crop.crop = {8, 4, 32, 8};
  const auto [width, height] = size_of(one, "a");
  CHECK(width >= 256);
  CHECK(width < 256 + 80);
  CHECK(size_of(five, "a").first > 5 * 256);
  CHECK(size_of(five, "a").second < height);
  CHECK(size_of(crop, "a").first == width);                     // 8 times as large
  CHECK(size_of(crop, "a").second == height - 7 * (128 - 64));  // 8 rows of 8
  CHECK(size_of(one, std::string(80, 'm')).first > 512);
}

TEST_CASE("A crop outside of the pictures is refused") {
  for (const psf::film::Crop& crop : std::vector<psf::film::Crop>{
           {0, 0, 0, 4}, {0, 0, 65, 4}, {60, 0, 5, 4}, {0, 30, 4, 3}, {1u << 30, 0, 4, 4}}) {
    psf::film::SheetOptions options;
    options.crop = crop;
    CHECK_THROWS_AS(ContactSheet(64, 32, options), psf::Error);
  }
  psf::film::SheetOptions none;
  none.columns = 0;
  CHECK_THROWS_AS(ContactSheet(64, 32, none), psf::Error);
}
