// Pictures come back from their files as they went in, and look right on a screen.
#include "film/image.h"

#include <OpenImageIO/imageio.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>

#include "catch.h"
#include "core/error.h"
#include "core/parallel.h"
#include "film/display.h"
#include "film/light_layers.h"
#include "film/picture.h"
#include "read_text.h"
#include "temp_folder.h"

using psf::Rgb;
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
    const std::string a = psf::tests::read_text(folder / (std::string("a.") + extension));
    CHECK(!a.empty());
    CHECK(a == psf::tests::read_text(folder / (std::string("b.") + extension)));
  }
}

TEST_CASE("what is written on several threads is the same bytes, and other programs read it") {
  const TempFolder folder;
  Image image;
  image.width = 61;
  image.height = 1203;  // more chunks than are in memory at once, the last one not full
  const std::size_t count = image.width * image.height;
  std::vector<float> constant(count, 0.5f), noise(count), smooth(count);
  std::mt19937 random(3);
  for (std::size_t i = 0; i < count; ++i) {
    // All bits, so that a chunk of it does not become shorter.
    noise[i] = std::bit_cast<float>(
        static_cast<std::uint32_t>((random() & 0x807fffffu) | ((100 + random() % 64) << 23)));
    smooth[i] = std::sin(0.001f * static_cast<float>(i));
  }
  image.layers = {{"smooth.Y", smooth}, {"R", constant}, {"noise.Y", noise}};
  std::string first;
  for (const std::size_t threads : {1u, 2u, 5u}) {
    const psf::core::ThreadLimit limit(threads);
    psf::film::write_exr(folder / "a.exr", image);
    const std::string bytes = psf::tests::read_text(folder / "a.exr");
    if (first.empty()) first = bytes;
    CHECK(bytes == first);
  }
  CHECK(first.size() < 12 * count * 9 / 10);
  const auto input = OIIO::ImageInput::open(folder / "a.exr");
  REQUIRE(input);
  const OIIO::ImageSpec& spec = input->spec();
  REQUIRE(spec.nchannels == 3);
  std::vector<float> values(3 * count);
  REQUIRE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, values.data()));
  for (int k = 0; k < 3; ++k) {
    const std::vector<float>* expected = image.find(spec.channelnames[static_cast<std::size_t>(k)]);
    REQUIRE(expected != nullptr);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < count; ++i) {
      wrong += values[3 * i + static_cast<std::size_t>(k)] == (*expected)[i] ? 0u : 1u;
    }
    CHECK(wrong == 0);
  }
  // Noise alone: chunks that are stored as they are.
  image.layers = {{"noise.Y", noise}};
  psf::film::write_exr(folder / "b.exr", image);
  CHECK(*psf::film::read_exr(folder / "b.exr").find("noise.Y") == noise);
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

TEST_CASE("a background that is apart is shown and compared, and no other one is") {
  const TempFolder folder;
  Image image;
  image.width = 2;
  image.height = 1;
  const std::vector<float> front = {0.25f, 0.5f, 0, 0, 0, 0}, behind = {0, 0, 0.125f, 0.5f, 1, 2},
                           both = {0.25f, 0.5f, 0.125f, 0.5f, 1, 2};
  image.add("", "RGB", both);
  const std::vector<std::uint8_t> shown = psf::film::encode_png(image);
  const std::vector<Rgb> colors = image.rgb();
  image.layers.clear();
  image.add("", "RGB", front);
  image.add("", "A", std::vector<float>{0.5f, 0});
  image.add("background.", "RGB", behind);
  image.add("unfiltered-input.", "RGB", behind);
  image.add("unfiltered-input.background.", "RGB", front);
  psf::film::write_exr(folder / "other.exr", image);  // a layer of this name of another program
  CHECK_FALSE(image.has_background());
  CHECK(psf::film::encode_png(image) != shown);
  const psf::film::Picture other = psf::film::read_picture(folder / "other.exr");
  CHECK(other.colors == image.rgb());
  CHECK(other.notes.size() == 1);
  image.attributes = {{psf::film::kBackgroundIs, psf::film::kApart}};
  psf::film::write_exr(folder / "apart.exr", image);
  CHECK(image.seen() == colors);
  CHECK(image.seen("unfiltered-input.") == colors);
  CHECK(psf::film::encode_png(image) == shown);
  CHECK(psf::film::encode_png(psf::film::read_exr(folder / "apart.exr")) == shown);
  for (const char* layer : {"", "unfiltered-input"}) {
    const psf::film::Picture apart = psf::film::read_picture(folder / "apart.exr", {layer, ""});
    CHECK(apart.colors == colors);
    CHECK(apart.notes.empty());
  }
  const psf::film::Picture alone =
      psf::film::read_picture(folder / "apart.exr", {"background", ""});
  CHECK(alone.colors == image.rgb("background."));
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
