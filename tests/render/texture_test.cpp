#include "render/scene/texture.h"

#include "catch.h"
#include "gltf_document.h"
#include "load_support.h"

namespace psf::render {
namespace {

// 2 x 2: red, green above blue, black.
Texture corners() {
  return Texture(2, 2, {Rgb(1, 0, 0), Rgb(0, 1, 0), Rgb(0, 0, 1), Rgb(0, 0, 0)});
}

Texture read_texture(const std::string& path, TextureUse use) {
  std::vector<std::string> notes;
  Texture texture = Texture::load(path, use, notes);
  CHECK(notes.empty());
  return texture;
}

void check_texel(const Rgb& got, const Rgb& expected) {
  for (int c = 0; c < 3; ++c) CHECK(got[c] == Approx(expected[c]).margin(1e-6));
}

TEST_CASE("a texture's rows go down while v goes up", "[texture]") {
  const Texture texture = corners();
  check_texel(texture.at({0.25f, 0.75f}), {1, 0, 0});
  check_texel(texture.at({0.75f, 0.75f}), {0, 1, 0});
  check_texel(texture.at({0.25f, 0.25f}), {0, 0, 1});
  check_texel(texture.texel(1, 0), {0, 1, 0});
}

TEST_CASE("lookups are bilinear between texel centres", "[texture]") {
  const Texture texture = corners();
  check_texel(texture.at({0.5f, 0.5f}), {0.25f, 0.25f, 0.25f});
  // 3/4 of the left column and 1/4 of the right, top row.
  check_texel(texture.at({0.375f, 0.75f}), {0.75f, 0.25f, 0});
  check_texel(texture.at({0.25f, 0.625f}), {0.75f, 0, 0.25f});
}

TEST_CASE("a texture repeats in both directions, over its edge too", "[texture]") {
  const Texture texture = corners();
  check_texel(texture.at({3.25f, -0.25f}), texture.at({0.25f, 0.75f}));
  // Between the last column and the first.
  check_texel(texture.at({1.0f, 0.75f}), {0.5f, 0.5f, 0});
  check_texel(texture.at({0.0f, 0.75f}), {0.5f, 0.5f, 0});
  check_texel(texture.at({0.25f, 1.0f}), {0.5f, 0, 0.5f});
  check_texel(texture.at({-1e-9f, 0.75f}), {0.5f, 0.5f, 0});
}

TEST_CASE("a lookup that is not finite gives some texel", "[texture]") {
  const Rgb color = corners().at({std::nanf(""), INFINITY});
  CHECK((color.x >= 0 && color.x <= 1));
}

TEST_CASE("8-bit files are sRGB or linear, as asked", "[texture]") {
  const TempFolder folder;
  const std::string path = folder.write("three.ppm", ppm(3, "188 188 188  255 0 0  10 0 0"));
  const Texture srgb = read_texture(path, TextureUse::reflectance);
  CHECK(srgb.width() == 3);
  CHECK(srgb.height() == 1);
  CHECK(srgb.texel(0, 0).x == Approx(0.5029).margin(1e-4));
  check_texel(srgb.texel(1, 0), {1, 0, 0});
  CHECK(srgb.texel(2, 0).x ==
        Approx(10 / 255.0 / 12.92).epsilon(1e-5));  // the straight part of the curve
  CHECK(read_texture(path, TextureUse::numbers).texel(0, 0).y == Approx(188 / 255.0));
}

TEST_CASE("grey becomes RGB, and float files are linear whatever is asked", "[texture]") {
  const TempFolder folder;
  check_texel(
      read_texture(folder.write("grey.pgm", "P2\n1 1\n255\n51\n"), TextureUse::numbers).texel(0, 0),
      {0.2f, 0.2f, 0.2f});
  // 1 x 1, little-endian: 0.5, 2, 0.25.
  const std::string values("\x00\x00\x00\x3f\x00\x00\x00\x40\x00\x00\x80\x3e", 12);
  const std::string pfm = folder.write("one.pfm", "PF\n1 1\n-1.0\n" + values);
  check_texel(read_texture(pfm, TextureUse::radiance).texel(0, 0), {0.5f, 2, 0.25f});
}

TEST_CASE("colours under a transparent alpha are as stored", "[texture]") {
  // A PNG of one texel, 255 102 51 and alpha 0.
  const std::string bytes = decode_base64(
      "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP4"
      "n2bMAAAFmQGZg+e4CgAAAABJRU5ErkJggg==");
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  std::vector<std::string> notes;
  const Texture texture =
      Texture::decode({data, bytes.size()}, "embedded", TextureUse::numbers, notes);
  check_texel(texture.texel(0, 0), {1, 0.4f, 0.2f});
}

TEST_CASE("a texture that is missing, no picture or empty is named", "[texture]") {
  const TempFolder folder;
  const auto failure = [](const std::string& path) {
    try {
      (void)read_texture(path, TextureUse::radiance);
    } catch (const Error& error) {
      return Failure{error.code(), error.what()};
    }
    return Failure{};
  };
  CHECK(failure("/nowhere/wood.png").code == ErrorCode::io);
  CHECK(failure("/nowhere/wood.png").message == "/nowhere/wood.png: no such picture");
  for (const char* text : {"not a picture", "", "P3\n2 2\n255\n1 2"}) {
    const Failure bad = failure(folder.write("bad.png", text));
    CHECK(bad.code == ErrorCode::bad_input);
    CHECK(contains(bad.message, "bad.png: cannot read the picture: "));
    CHECK(!contains(bad.message, "\n"));
  }
  CHECK_THROWS_AS(Texture(2, 2, {Rgb(0)}), Error);
}

}  // namespace
}  // namespace psf::render
