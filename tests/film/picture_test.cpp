// Pictures of other programs are read as what they are, or refused by name.
#include "film/picture.h"

#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>

#include <algorithm>
#include <fstream>

#include "catch.h"
#include "core/error.h"
#include "exr_samples.h"
#include "temp_folder.h"

using psf::Rgb;
using psf::film::Picture;
using psf::film::read_picture;
using namespace psf::tests;

namespace {

std::string refusal(const std::string& path, psf::ErrorCode code) {
  try {
    (void)read_picture(path);
  } catch (const psf::Error& error) {
    CHECK(error.code() == code);
    const std::string text = error.what();
    CHECK(text.starts_with(path + ": "));
    CHECK(text.find('\n') == std::string::npos);
    return text.substr(path.size() + 2);
  }
  return "nothing";
}

// Whether the picture has the sample's values in `window` and black elsewhere.
bool is_sample(const Picture& picture, const Imath::Box2i& window, float scale = 1) {
  for (std::size_t i = 0; i < picture.colors.size(); ++i) {
    const int x = picture.left + static_cast<int>(i % picture.width);
    const int y = picture.top + static_cast<int>(i / picture.width);
    for (int k = 0; k < 3; ++k) {
      const float expected = window.intersects(Imath::V2i(x, y)) ? sample_value(x, y, k) : 0;
      if (picture.colors[i][k] != scale * expected) return false;
    }
  }
  return picture.colors.size() == picture.width * picture.height;
}

// Levels beyond the first hold 0.
void write_tiles(const std::string& path, const Imf::Header& header, bool mipmap) {
  Imf::TiledOutputFile file(path.c_str(), header, 0);
  for (int level = 0; level < (mipmap ? file.numLevels() : 1); ++level) {
    SamplePixels pixels(file.dataWindowForLevel(level), kRgb);
    for (std::vector<SamplePixels::Plane>& plane : pixels.planes) {
      if (level > 0) std::fill(plane.begin(), plane.end(), SamplePixels::Plane{0});
    }
    file.setFrameBuffer(pixels.buffer);
    file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
  }
}

}  // namespace

TEST_CASE("float, half and whole numbers of every lossless compression are read") {
  const TempFolder folder;
  const Imath::Box2i window = box(0, 0, 37, 41);
  for (const Imf::Compression compression :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION,
        Imf::PIZ_COMPRESSION}) {
    for (const Imf::PixelType type : {Imf::FLOAT, Imf::HALF, Imf::UINT}) {
      const std::vector<SampleChannel> channels = {{"R", type}, {"G", type}, {"B", type}};
      write_lines(folder / "a.exr", sample_header(window, window, channels, compression), channels);
      const Picture picture = read_picture(folder / "a.exr");
      INFO(compression << " " << type);
      CHECK(is_sample(picture, window, type == Imf::UINT ? 4.0f : 1.0f));
      CHECK(picture.notes.empty());
    }
  }
}

TEST_CASE("tiles are read, and of a mipmap the whole picture") {
  const TempFolder folder;
  const Imath::Box2i window = box(0, 0, 70, 45);
  for (const bool mipmap : {false, true}) {
    Imf::Header header = sample_header(window, window, kRgb);
    header.setTileDescription({16, 8, mipmap ? Imf::MIPMAP_LEVELS : Imf::ONE_LEVEL});
    write_tiles(folder / "a.exr", header, mipmap);
    CHECK(is_sample(read_picture(folder / "a.exr"), window));
  }
}

TEST_CASE("a part of several is read by its name") {
  const TempFolder folder;
  const Imath::Box2i window = box(0, 0, 8, 6);
  {
    std::vector<Imf::Header> headers(2, sample_header(window, window, kRgb));
    headers[0] = sample_header(window, window, {{"Z"}});
    headers[0].setName("depth");
    headers[1].setName("rgba");
    for (Imf::Header& header : headers) header.setType(Imf::SCANLINEIMAGE);
    Imf::MultiPartOutputFile file((folder / "a.exr").c_str(), headers.data(), 2);
    for (int part = 0; part < 2; ++part) {
      SamplePixels pixels(window, part == 0 ? std::vector<SampleChannel>{{"Z"}} : kRgb);
      Imf::OutputPart output(file, part);
      output.setFrameBuffer(pixels.buffer);
      output.writePixels(6);
    }
  }
  const Picture picture = read_picture(folder / "a.exr");
  CHECK(is_sample(picture, window));
  CHECK(picture.layer == "rgba");
  REQUIRE(picture.notes.size() == 1);
  CHECK(picture.notes[0] ==
        folder / "a.exr" + ": has no colours at its root, its layer rgba is taken");
  CHECK(is_sample(read_picture(folder / "a.exr", {"rgba", "", "`layer`"}), window));
}

TEST_CASE("a part beside the wanted one may be what cannot be read") {
  const TempFolder folder;
  const Imath::Box2i window = box(0, 0, 8, 6);
  {
    std::vector<Imf::Header> headers(2, sample_header(window, window, kRgb, Imf::ZIPS_COMPRESSION));
    headers[0].setName("deep");
    headers[0].setType(Imf::DEEPSCANLINE);
    headers[1].setName("flat");
    headers[1].setType(Imf::SCANLINEIMAGE);
    Imf::MultiPartOutputFile file((folder / "a.exr").c_str(), headers.data(), 2);
    SamplePixels pixels(window, kRgb);
    Imf::OutputPart output(file, 1);
    output.setFrameBuffer(pixels.buffer);
    output.writePixels(6);
  }
  CHECK(is_sample(read_picture(folder / "a.exr", {"flat", "", "`layer`"}), window));
  try {
    (void)read_picture(folder / "a.exr", {"deep", "", "`layer`"});
    FAIL("was read");
  } catch (const psf::Error& error) {
    CHECK(std::string(error.what()).find("deep pixels") != std::string::npos);
  }
}

TEST_CASE("luminance and chroma become colours, luminance alone grey") {
  const TempFolder folder;
  {
    std::vector<Imf::Rgba> pixels(32 * 24, Imf::Rgba(0.5f, 0.25f, 0.125f));
    Imf::RgbaOutputFile file((folder / "a.exr").c_str(), 32, 24, Imf::WRITE_YC);
    file.setFrameBuffer(pixels.data(), 1, 32);
    file.writePixels(24);
  }
  const Picture picture = read_picture(folder / "a.exr");
  for (const Rgb& color : picture.colors) {
    REQUIRE(color.x == Approx(0.5f).epsilon(0.01));
    REQUIRE(color.y == Approx(0.25f).epsilon(0.01));
    REQUIRE(color.z == Approx(0.125f).epsilon(0.02));
  }
  const std::vector<SampleChannel> luminance = {{"Y", Imf::HALF}};
  write_lines(folder / "y.exr", sample_header(box(0, 0, 5, 4), box(0, 0, 5, 4), luminance),
              luminance);
  for (const Rgb& color : read_picture(folder / "y.exr").colors) {
    CHECK(color.x == color.z);
    CHECK(color.y == color.x);
  }
}

TEST_CASE("pixels lie where the data window has them") {
  const TempFolder folder;
  const Imath::Box2i display = box(0, 0, 20, 16);
  for (const Imath::Box2i& data :
       {box(5, 3, 9, 8), box(-4, -3, 40, 30), box(-4, 2, 9, 40), box(100, 100, 4, 4)}) {
    write_lines(folder / "a.exr", sample_header(display, data, kRgb), kRgb);
    const Picture picture = read_picture(folder / "a.exr");
    CHECK(picture.width == 20);
    CHECK(picture.height == 16);
    CHECK(is_sample(picture, data));
    REQUIRE(picture.notes.size() == 1);
    CHECK(picture.notes[0].find("0,0,20x16") != std::string::npos);
  }
  const Imath::Box2i elsewhere = box(-7, 9, 20, 16);
  write_lines(folder / "b.exr", sample_header(elsewhere, elsewhere, kRgb), kRgb);
  const Picture b = read_picture(folder / "b.exr"), a = read_picture(folder / "a.exr");
  CHECK(is_sample(b, elsewhere));
  CHECK_THROWS_AS(check_comparable(a, b), psf::Error);
}

TEST_CASE("alpha is told where it is not one, and colours without it are multiplied") {
  const TempFolder folder;
  const Imath::Box2i window = box(0, 0, 8, 8);
  const std::vector<SampleChannel> rgba = {{"R"}, {"G"}, {"B"}, {"A"}};
  Imf::Header header = sample_header(window, window, rgba);
  write_lines(folder / "a.exr", header, rgba);
  const Picture a = read_picture(folder / "a.exr");
  CHECK(is_sample(a, window));
  REQUIRE(a.notes.size() == 1);
  CHECK(a.notes[0].ends_with("not opaque; their colours are taken as they are, over black"));
  header.insert("oiio:UnassociatedAlpha", Imf::IntAttribute(1));
  write_lines(folder / "b.exr", header, rgba);
  const Picture b = read_picture(folder / "b.exr");
  for (std::size_t i = 0; i < 64; ++i) {
    const int x = static_cast<int>(i % 8), y = static_cast<int>(i / 8);
    CHECK(b.colors[i] == a.colors[i] * sample_value(x, y, 3));
  }
  REQUIRE(b.notes.size() == 1);
  CHECK(b.notes[0].ends_with(
      "their colours are taken times alpha, as the file has them without it, over black"));
}

TEST_CASE("primaries and projections that differ are told") {
  const TempFolder folder;
  const Imath::Box2i window = box(0, 0, 4, 4);
  Imf::Header header = sample_header(window, window, kRgb);
  write_lines(folder / "a.exr", header, kRgb);
  Imf::addChromaticities(header, Imf::Chromaticities());
  write_lines(folder / "same.exr", header, kRgb);
  Imf::addChromaticities(header, Imf::Chromaticities({0.7347f, 0.2653f}, {0, 1}, {0.0001f, -0.077f},
                                                     {0.32168f, 0.33767f}));
  write_lines(folder / "aces.exr", header, kRgb);
  const Picture a = read_picture(folder / "a.exr");
  CHECK(check_comparable(a, read_picture(folder / "same.exr")).empty());
  CHECK(check_comparable(a, read_picture(folder / "aces.exr")).find("primaries") !=
        std::string::npos);
  Imf::Header map = sample_header(window, window, kRgb);
  Imf::addEnvmap(map, Imf::ENVMAP_LATLONG);
  write_lines(folder / "map.exr", map, kRgb);
  CHECK_THROWS_AS(check_comparable(a, read_picture(folder / "map.exr")), psf::Error);
}

TEST_CASE("what cannot be honoured is refused by name") {
  const TempFolder folder;
  const Imath::Box2i window = box(0, 0, 64, 40);
  const Imf::Header plain = sample_header(window, window, kRgb);
  const auto refused = [&](const Imf::Header& header, int lines = -1) {
    write_lines(folder / "a.exr", header, kRgb, lines);
    return refusal(folder / "a.exr", psf::ErrorCode::bad_input);
  };
  Imf::Header turned = plain;
  turned.insert("Orientation", Imf::IntAttribute(6));
  CHECK(refused(turned).find("Orientation is 6") != std::string::npos);
  Imf::Header display = plain;
  display.insert("oiio:ColorSpace", Imf::StringAttribute("sRGB"));
  CHECK(refused(display).find("not linear") != std::string::npos);
  Imf::Header linear = plain;
  linear.insert("oiio:ColorSpace", Imf::StringAttribute("sRGB - Linear"));
  CHECK(refused(linear) == "nothing");
  CHECK(refused(plain, 20).find("incomplete") != std::string::npos);

  const std::vector<SampleChannel> depth = {{"Z"}};
  write_lines(folder / "z.exr", sample_header(window, window, depth), depth);
  CHECK(refusal(folder / "z.exr", psf::ErrorCode::bad_input) == "has no channels R, G, B, nor Y");
  CHECK(refusal(folder / "none.exr", psf::ErrorCode::io).find("cannot be read") == 0);
  std::ofstream(folder / "text.exr") << "no picture";
  CHECK(refusal(folder / "text.exr", psf::ErrorCode::bad_input).find("does not begin") !=
        std::string::npos);

  {
    Imf::Header coarse = plain;
    coarse.channels().insert("B", Imf::Channel(Imf::FLOAT, 2, 2));
    std::vector<float> values(64 * 40);
    Imf::OutputFile file((folder / "s.exr").c_str(), coarse, 0);
    Imf::FrameBuffer buffer;
    for (const char* name : {"R", "G"}) {
      buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, values.data(), window));
    }
    buffer.insert("B", Imf::Slice::Make(Imf::FLOAT, values.data(), window, 0, 0, 2, 2));
    file.setFrameBuffer(buffer);
    file.writePixels(40);
  }
  CHECK(
      refusal(folder / "s.exr", psf::ErrorCode::bad_input).find("channel B has only each 2 x 2") !=
      std::string::npos);

  {
    Imf::Header deep = sample_header(box(0, 0, 1, 1), box(0, 0, 1, 1), kRgb, Imf::ZIPS_COMPRESSION);
    deep.setType(Imf::DEEPSCANLINE);
    Imf::DeepScanLineOutputFile file((folder / "d.exr").c_str(), deep, 0);
  }
  CHECK(refusal(folder / "d.exr", psf::ErrorCode::bad_input).find("deep pixels") !=
        std::string::npos);
}
