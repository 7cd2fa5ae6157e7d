// A relit picture is the weighted sum of its layers, and can be relit again.
#include "film/relight.h"

#include <limits>

#include "catch.h"
#include "core/error.h"
#include "film/attributes.h"
#include "read_text.h"
#include "temp_folder.h"

namespace psf {
namespace {

using film::Image;

// Two layers, in the picture and in its input, and a channel beside them.
Image lit() {
  Image image;
  image.path = "lit.exr";
  image.width = 3;
  image.height = 2;
  const std::vector<std::vector<float>> sun = {{0, 1, 2, 3, 4, 5}, {1, 1, 1, 1, 1, 1}},
                                        sky = {{5, 4, 3, 2, 1, 0}, {2, 2, 0, 0, 2, 2}};
  for (const std::size_t k : {0u, 1u}) {
    const std::string prefix = k == 0 ? "" : "unfiltered-input.";
    for (const char* colour : {"R", "G", "B"}) {
      std::vector<float> sum(6);
      for (std::size_t pixel = 0; pixel < 6; ++pixel) sum[pixel] = sun[k][pixel] + sky[k][pixel];
      image.layers.push_back({prefix + colour, sum});
      image.layers.push_back({prefix + "sun." + colour, sun[k]});
      image.layers.push_back({prefix + "sky." + colour, sky[k]});
    }
  }
  image.layers.push_back({"neighbors.Y", {1, 2, 3, 4, 5, 6}});
  image.attributes = {{"psf:version", "0"}, {film::kLightLayers, "sun,sky"}};
  return image;
}

std::string message_of(const Image& image, const film::LightWeights& weights, ErrorCode code) {
  try {
    static_cast<void>(film::relight(image, weights));
    return "none";
  } catch (const Error& error) {
    CHECK(error.code() == code);
    return error.what();
  }
}

TEST_CASE("A relit picture is the weighted sum of its layers, its input too") {
  const Image image = lit();
  const Image relit = film::relight(image, {{"sun", Rgb(2, 0.5f, 0)}, {"sky", Rgb(3)}});
  for (const char* prefix : {"", "unfiltered-input."}) {
    const std::string p = prefix;
    const auto sun = image.rgb(p + "sun."), sky = image.rgb(p + "sky."), all = relit.rgb(p);
    for (std::size_t pixel = 0; pixel < 6; ++pixel) {
      CHECK(all[pixel] == sun[pixel] * Rgb(2, 0.5f, 0) + sky[pixel] * 3.0f);
      CHECK(relit.rgb(p + "sun.")[pixel] == sun[pixel] * Rgb(2, 0.5f, 0));
      CHECK(relit.rgb(p + "sky.")[pixel] == sky[pixel] * 3.0f);
    }
  }
  CHECK(*relit.find("neighbors.Y") == *image.find("neighbors.Y"));
  CHECK(relit.attributes == film::Attributes{{"psf:light-layers", "sun,sky"},
                                             {"psf:relight", "sky=3 sun=2,0.5,0"},
                                             {"psf:version", "0"}});
}

TEST_CASE("A layer that is not named keeps its light, and one of weight 0 leaves nothing") {
  const Image image = lit();
  CHECK(film::relight(image, {{"sky", Rgb(0)}}).rgb() == image.rgb("sun."));
  CHECK(film::relight(image, {}).rgb() == image.rgb());
}

TEST_CASE("Light that is in no layer stays") {
  Image image = lit();
  image.attributes.back().second = "sky";
  CHECK(film::relight(image, {{"sky", Rgb(1)}}).rgb() == image.rgb());
  CHECK(film::relight(image, {{"sky", Rgb(0)}}).rgb() == image.rgb("sun."));
  const auto sun = image.rgb("sun."), sky = image.rgb("sky.");
  const auto relit = film::relight(image, {{"sky", Rgb(-2)}}).rgb();
  for (std::size_t pixel = 0; pixel < 6; ++pixel) {
    CHECK(relit[pixel] == sun[pixel] + sky[pixel] * -2.0f);
  }
}

TEST_CASE("Channels with long names are written and read") {
  const tests::TempFolder folder;
  Image image = lit();
  const std::string name = std::string(40, 'x') + ".R";
  image.layers.push_back({name, {1, 2, 3, 4, 5, 6}});
  film::write_exr(folder / "long.exr", image);
  const Image read = film::read_exr(folder / "long.exr");
  REQUIRE(read.find(name) != nullptr);
  CHECK(*read.find(name) == *image.find(name));
  // Files without any are as they were: the flag is not set (byte 5, bit 2).
  film::write_exr(folder / "short.exr", lit());
  CHECK((tests::read_text(folder / "long.exr")[5] & 4) != 0);
  CHECK((tests::read_text(folder / "short.exr")[5] & 4) == 0);
}

TEST_CASE("What is relit is written, read and relit again") {
  const tests::TempFolder folder;
  const Image once = film::relight(lit(), {{"sun", Rgb(4)}});
  film::write_exr(folder / "once.exr", once);
  const Image twice = film::relight(film::read_exr(folder / "once.exr"), {{"sun", Rgb(0.25f)}});
  CHECK(twice.rgb() == lit().rgb());
  film::write_exr(folder / "twice.exr", twice);
  const Image read = film::read_exr(folder / "twice.exr");
  bool told = false;
  for (const auto& [name, text] : read.attributes) {
    told = told || (name == "psf:relight" && text == "sun=4; sun=0.25");
  }
  CHECK(told);
}

TEST_CASE("What cannot be relit is an error that names the file and what there is") {
  Image image = lit();
  CHECK(message_of(image, {{"moon", Rgb(1)}}, ErrorCode::usage) ==
        "lit.exr: has no layer moon of the light; there are sun, sky");
  CHECK(message_of(image, {{"sun", Rgb(std::numeric_limits<float>::infinity())}},
                   ErrorCode::usage) == "lit.exr: the weight of layer sun is not finite");
  image.attributes.back().second = "sun,sky,lamp";
  CHECK(message_of(image, {}, ErrorCode::bad_input).starts_with("lit.exr: has no channel lamp.R"));
  image.attributes.pop_back();
  CHECK(message_of(image, {}, ErrorCode::bad_input)
            .starts_with("lit.exr: has no layers of the light"));
}

TEST_CASE("A background that is apart is weighed by its name, and is in no other colour") {
  Image image = lit();
  for (const char* channel :
       {"background.R", "background.G", "background.B", "unfiltered-input.background.R",
        "unfiltered-input.background.G", "unfiltered-input.background.B"}) {
    image.layers.push_back({channel, {6, 5, 4, 3, 2, 1}});
  }
  CHECK(message_of(image, {{"background", Rgb(2)}}, ErrorCode::usage).find("there are sun, sky") !=
        std::string::npos);  // a layer of that name, not apart
  image.attributes.emplace_back(film::kBackgroundIs, film::kApart);
  const Image relit = film::relight(image, {{"background", Rgb(2, 0, 1)}, {"sun", Rgb(0)}});
  for (const char* prefix : {"", "unfiltered-input."}) {
    const std::string p = prefix;
    CHECK(relit.rgb(p) == image.rgb(p + "sky."));
    const auto before = image.rgb(p + "background."), after = relit.rgb(p + "background."),
               seen = relit.seen(p), sky = image.rgb(p + "sky.");
    for (std::size_t pixel = 0; pixel < 6; ++pixel) {
      CHECK(after[pixel] == before[pixel] * Rgb(2, 0, 1));
      CHECK(seen[pixel] == sky[pixel] + after[pixel]);
    }
  }
  std::erase_if(image.attributes, [](const auto& one) { return one.first == film::kLightLayers; });
  const Image dark = film::relight(image, {{"background", Rgb(0)}});
  CHECK(dark.rgb() == image.rgb());
  CHECK(dark.seen() == image.rgb());
}

}  // namespace
}  // namespace psf
