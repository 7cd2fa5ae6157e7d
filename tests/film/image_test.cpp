// Pictures come back from their files as they went in, and look right on a screen.
#include "film/image.h"

#include <OpenImageIO/imageio.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "catch.h"
#include "core/error.h"
#include "film/display.h"
#include "temp_folder.h"

using psf::film::Image;
using psf::tests::TempFolder;

namespace {

Image sample() {
  Image image;
  image.width = 3;
  image.height = 2;
  std::vector<float> colors(18);
  for (std::size_t i = 0; i < colors.size(); ++i) colors[i] = 0.1f * static_cast<float>(i);
  image.add("", "RGB", colors);
  image.add("neighbors.", "Y", std::vector<float>{1, 2, 3, NAN, INFINITY, -6});
  image.attributes = {{"psf:r0", "8px"}, {"psf:version", "0.1.0"}};
  return image;
}

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

psf::ErrorCode code_of(const std::string& path) {
  try {
    (void)psf::film::read_exr(path);
  } catch (const psf::Error& error) {
    CHECK(std::string(error.what()).starts_with(path));
    return error.code();
  }
  return psf::ErrorCode::usage;
}

}  // namespace

TEST_CASE("an EXR keeps every channel, value and attribute") {
  const TempFolder folder;
  const Image image = sample();
  psf::film::write_image(folder / "a.exr", image);
  const Image read = psf::film::read_exr(folder / "a.exr");
  REQUIRE(read.width == 3);
  REQUIRE(read.height == 2);
  CHECK(read.rgb() == image.rgb());
  const auto& neighbors = *read.find("neighbors.Y");
  CHECK(std::isnan(neighbors[3]));
  CHECK(neighbors[4] == INFINITY);
  CHECK(neighbors[5] == -6);
  for (const auto& attribute : image.attributes) {
    CHECK(std::find(read.attributes.begin(), read.attributes.end(), attribute) !=
          read.attributes.end());
  }
}

TEST_CASE("the same picture gives the same bytes") {
  const TempFolder folder;
  for (const char* extension : {"exr", "png"}) {
    psf::film::write_image(folder / (std::string("a.") + extension), sample());
    psf::film::write_image(folder / (std::string("b.") + extension), sample());
    const std::string a = bytes_of(folder / (std::string("a.") + extension));
    CHECK(!a.empty());
    CHECK(a == bytes_of(folder / (std::string("b.") + extension)));
  }
}

TEST_CASE("other programs find R, G, B at the root of the EXR, row 0 on top") {
  const TempFolder folder;
  psf::film::write_image(folder / "a.exr", sample());
  const auto input = OIIO::ImageInput::open(folder / "a.exr");
  REQUIRE(input);
  CHECK(input->spec().channelnames.size() == 4);
  CHECK(input->spec().channelnames[0] == "R");
  std::vector<float> values(24);
  REQUIRE(input->read_image(0, 0, 0, 4, OIIO::TypeDesc::FLOAT, values.data()));
  CHECK(values[4 * 3 + 1] == 1.0f);  // row 1, column 0, G
}

TEST_CASE("a PNG is tone-mapped and sRGB") {
  const TempFolder folder;
  Image image;
  image.width = 4;
  image.height = 1;
  image.add("", "RGB",
            std::vector<float>{0, 0, 0, 0.5f, 0.5f, 0.5f, 1000, 1000, 1000, NAN, -1, 0.2140411f});
  psf::film::write_image(folder / "a.png", image);
  const auto input = OIIO::ImageInput::open(folder / "a.png");
  REQUIRE(input);
  std::vector<unsigned char> values(12);
  REQUIRE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, values.data()));
  CHECK(values == std::vector<unsigned char>{0, 0, 0, 188, 188, 188, 255, 255, 255, 0, 0, 127});
}

TEST_CASE("the tone curve rises and joins smoothly") {
  float last = 0;
  for (float x = 0.01f; x < 8; x += 0.01f) {
    const float y = psf::film::tone_map(x);
    CHECK(y >= last);
    CHECK(y - last < 0.0101f);
    last = y;
  }
}

TEST_CASE("bad picture files and names are one clear error each") {
  const TempFolder folder;
  CHECK(code_of(folder / "missing.exr") == psf::ErrorCode::io);
  std::ofstream(folder / "text.exr") << "no picture";
  CHECK(code_of(folder / "text.exr") == psf::ErrorCode::bad_input);
  psf::film::write_image(folder / "cut.exr", sample());
  std::filesystem::resize_file(folder / "cut.exr", 300);
  CHECK(code_of(folder / "cut.exr") == psf::ErrorCode::bad_input);
  CHECK_THROWS_AS(psf::film::check_image_path(folder / "a.jpg"), psf::Error);
  CHECK_THROWS_AS(psf::film::check_image_path(folder / "nowhere/a.png"), psf::Error);
}
