// What picture files say of their pixels is honoured or refused by name, and values out of range
// are clamped, whatever kind of scene asks for them.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfEnvmapAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenImageIO/imageio.h>

#include "catch.h"
#include "load_support.h"

namespace psf::render {
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;

// Writes the values (height, width, channels), and forgets what OpenImageIO remembers of the name.
std::string write_picture(const TempFolder& folder, const std::string& name, const ImageSpec& spec,
                          const std::vector<float>& values) {
  const std::string path = folder.write(name, "");
  const auto out = OIIO::ImageOutput::create(path);
  REQUIRE(out);
  REQUIRE(out->open(path, spec));
  REQUIRE(out->write_image(TypeDesc::FLOAT, values.data()));
  REQUIRE(out->close());
  return path;
}

struct Loaded {
  Texture texture;
  std::vector<std::string> notes;
};

Loaded load(const std::string& path, TextureUse use = TextureUse::reflectance) {
  std::vector<std::string> notes;
  Texture texture = Texture::load(path, use, notes);
  return {std::move(texture), notes};
}

std::string refusal(const std::string& path, TextureUse use = TextureUse::radiance) {
  try {
    (void)load(path, use);
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::bad_input);
    CHECK(std::string(error.what()).find(path) == 0);
    return error.what();
  }
  return "";
}

void check_read(const Rgb& got, const Rgb& expected, double margin = 1e-3) {
  for (int c = 0; c < 3; ++c) CHECK(double{got[c]} == Approx(double{expected[c]}).margin(margin));
}

TEST_CASE("a picture is turned and mirrored as its orientation says", "[texture]") {
  const TempFolder folder;
  // What is seen of rows ab, cd, ef, by the words of TIFF 6.0: where the first row and the first
  // column are.
  const std::vector<std::vector<std::string>> seen = {{"ab", "cd", "ef"},  // 1: top, left
                                                      {"ba", "dc", "fe"},  // 2: top, right
                                                      {"fe", "dc", "ba"},  // 3: bottom, right
                                                      {"ef", "cd", "ab"},  // 4: bottom, left
                                                      {"ace", "bdf"},      // 5: left, top
                                                      {"eca", "fdb"},      // 6: right, top
                                                      {"fdb", "eca"},      // 7: right, bottom
                                                      {"bdf", "ace"}};     // 8: left, bottom
  std::vector<float> values;
  for (int k = 0; k < 6; ++k) values.insert(values.end(), 3, static_cast<float>(k) / 8);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    CAPTURE(k + 1);
    ImageSpec spec(2, 3, 3, TypeDesc::FLOAT);
    spec.attribute("Orientation", static_cast<int>(k) + 1);
    const Texture texture = load(write_picture(folder, "o.tif", spec, values)).texture;
    REQUIRE(texture.height() == seen[k].size());
    REQUIRE(texture.width() == seen[k][0].size());
    std::vector<std::string> rows;
    for (std::size_t y = 0; y < texture.height(); ++y) {
      rows.emplace_back();
      for (std::size_t x = 0; x < texture.width(); ++x)
        rows.back() += static_cast<char>('a' + std::lround(8 * texture.texel(x, y).x));
    }
    CHECK(rows == seen[k]);
  }
}

TEST_CASE("an OpenEXR fills its display window, black around the data", "[texture]") {
  const TempFolder folder;
  ImageSpec spec(2, 1, 3, TypeDesc::HALF);
  spec.x = 3, spec.y = 2;
  spec.full_x = 1, spec.full_y = 1, spec.full_width = 4, spec.full_height = 3;
  const Texture texture =
      load(write_picture(folder, "w.exr", spec, {0.25f, 0.5f, 0.75f, 1, 0, 0})).texture;
  REQUIRE(texture.width() == 4);
  REQUIRE(texture.height() == 3);
  check_read(texture.texel(2, 1), {0.25f, 0.5f, 0.75f});
  check_read(texture.texel(3, 1), {1, 0, 0});
  for (std::size_t i = 0; i < 12; ++i) {
    if (i / 4 != 1 || i % 4 < 2) check_read(texture.texel(i % 4, i / 4), Rgb(0));
  }
  // Overscan is cut.
  spec = ImageSpec(3, 1, 3, TypeDesc::HALF);
  spec.x = -1, spec.full_width = 1, spec.full_height = 1;
  const Texture cut =
      load(write_picture(folder, "c.exr", spec, {1, 1, 1, 0.5f, 0.25f, 0, 1, 1, 1})).texture;
  REQUIRE(cut.width() == 1);
  check_read(cut.texel(0, 0), {0.5f, 0.25f, 0});
  spec.x = 5;
  CHECK(contains(refusal(write_picture(folder, "o.exr", spec, std::vector<float>(9, 0.5f))),
                 "outside its display window"));
}

TEST_CASE("premultiplied colours are divided by alpha, light is not", "[texture]") {
  const TempFolder folder;
  const ImageSpec spec(2, 1, 4, TypeDesc::FLOAT);
  const std::vector<float> values = {0.25f, 0.125f, 0, 0.5f, 0.25f, 0.25f, 0.25f, 0};
  const std::string path = write_picture(folder, "a.exr", spec, values);
  check_read(load(path).texture.texel(0, 0), {0.5f, 0.25f, 0});
  check_read(load(path).texture.texel(1, 0), {0.25f, 0.25f, 0.25f});
  check_read(load(path, TextureUse::radiance).texture.texel(0, 0), {0.25f, 0.125f, 0});
}

TEST_CASE("colours of other primaries become those of Rec. 709", "[texture]") {
  const TempFolder folder;
  // ACES2065-1; the matrix to Rec. 709 with Bradford's adaptation as it is published.
  const float aces[8] = {0.7347f, 0.2653f, 0.0f, 1.0f, 0.0001f, -0.077f, 0.32168f, 0.33767f};
  const float wide[8] = {0.708f, 0.292f, 0.17f, 0.797f, 0.131f, 0.046f, 0.3127f, 0.329f};
  ImageSpec spec(1, 1, 3, TypeDesc::FLOAT);
  spec.attribute("chromaticities", TypeDesc(TypeDesc::FLOAT, 8), aces);
  const Texture a = load(write_picture(folder, "a.exr", spec, {0.3f, 0.2f, 0.1f})).texture;
  check_read(a.texel(0, 0),
             {0.3f * 2.5217f - 0.2f * 1.1341f - 0.1f * 0.3876f,
              -0.3f * 0.2765f + 0.2f * 1.3727f - 0.1f * 0.0962f,
              -0.3f * 0.0154f - 0.2f * 0.1530f + 0.1f * 1.1684f},
             2e-3);
  // Rec. 2020 has the same white; its published matrix.
  spec.attribute("chromaticities", TypeDesc(TypeDesc::FLOAT, 8), wide);
  const std::string path = write_picture(folder, "w.exr", spec, {0.3f, 0.2f, 0.1f});
  check_read(load(path, TextureUse::radiance).texture.texel(0, 0),
             {0.3f * 1.6605f - 0.2f * 0.5876f - 0.1f * 0.0728f,
              -0.3f * 0.1246f + 0.2f * 1.1329f - 0.1f * 0.0083f,
              -0.3f * 0.0182f - 0.2f * 0.1006f + 0.1f * 1.1187f},
             2e-3);
  check_read(load(path, TextureUse::numbers).texture.texel(0, 0), {0.3f, 0.2f, 0.1f});
}

TEST_CASE("a gamma of the file replaces sRGB, unless the scene says otherwise", "[texture]") {
  const TempFolder folder;
  ImageSpec spec(1, 1, 3, TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "GammaCorrected1.8");
  spec.attribute("oiio:Gamma", 1.8f);
  const std::vector<float> grey(3, 0.6f);
  const std::string path = write_picture(folder, "g.png", spec, grey);
  check_read(load(path).texture.texel(0, 0), Rgb(std::pow(153 / 255.0f, 1.8f)));
  check_read(load(path, TextureUse::numbers).texture.texel(0, 0), Rgb(153 / 255.0f));
  std::vector<std::string> notes;
  check_read(Texture::load(path, TextureUse::reflectance, notes, true).texel(0, 0),
             Rgb(srgb_to_linear(153 / 255.0f)));
  spec.attribute("oiio:ColorSpace", "Linear");
  spec.attribute("oiio:Gamma", 1.0f);
  check_read(load(write_picture(folder, "l.png", spec, grey)).texture.texel(0, 0),
             Rgb(153 / 255.0f));
  const ImageSpec plain(1, 1, 3, TypeDesc::UINT16);
  check_read(load(write_picture(folder, "s.png", plain, grey)).texture.texel(0, 0),
             Rgb(srgb_to_linear(0.6f)));
}

TEST_CASE("cube maps and chroma are refused by name", "[texture]") {
  const TempFolder folder;
  const auto write = [&](const char* name, Imf::Envmap kind) {
    const std::string path = folder.write(name, "");
    Imf::Header header(4, 24);
    Imf::addEnvmap(header, kind);
    std::vector<float> values(4 * 24, 0.5f);
    Imf::FrameBuffer frame;
    for (const char* channel : {"R", "G", "B"}) {
      header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
      frame.insert(channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()),
                                       sizeof(float), 4 * sizeof(float)));
    }
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(frame);
    file.writePixels(24);
    return path;
  };
  const std::string cube = write("cube.exr", Imf::ENVMAP_CUBE);
  CHECK(contains(refusal(cube), "is a cube map (OpenEXR's envmap says so)"));
  CHECK(contains(refusal(cube, TextureUse::reflectance), "is a cube map"));
  CHECK(load(write("round.exr", Imf::ENVMAP_LATLONG)).texture.height() == 24);
  const std::string scene =
      folder.write("s.json", R"({"environment": {"map": "cube.exr"}, "materials": [{"name": "a"}],
                    "shapes": [{"shape": "sphere", "center": [0,0,0], "radius": 1,
                                "material": "a"}]})");
  CHECK(
      contains(load_failure(scene).message, "s.json:1: /environment/map: cube.exr: is a cube map"));

  ImageSpec spec(1, 1, 3, TypeDesc::HALF);
  spec.channelnames = {"BY", "RY", "Y"};
  CHECK(contains(refusal(write_picture(folder, "y.exr", spec, {0, 0, 1})), "chroma"));
}

TEST_CASE("colours are found by name, layers and parts are told", "[texture]") {
  const TempFolder folder;
  ImageSpec spec(1, 1, 4, TypeDesc::HALF);
  spec.channelnames = {"beauty.B", "beauty.G", "beauty.R", "depth.Z"};
  spec.alpha_channel = -1;
  const Loaded layered = load(write_picture(folder, "l.exr", spec, {0.1f, 0.2f, 0.3f, 9}));
  check_read(layered.texture.texel(0, 0), {0.3f, 0.2f, 0.1f});
  REQUIRE(layered.notes.size() == 1);
  CHECK(contains(layered.notes[0], "l.exr: has layers, beauty.RGB is taken"));

  const std::string path = folder.write("p.exr", "");
  const auto out = OIIO::ImageOutput::create(path);
  const ImageSpec part(1, 1, 3, TypeDesc::HALF);
  const ImageSpec parts[] = {part, part};
  REQUIRE(out->open(path, 2, parts));
  const float first[3] = {0.5f, 0.25f, 0}, second[3] = {1, 1, 1};
  REQUIRE(out->write_image(TypeDesc::FLOAT, first));
  REQUIRE(out->open(path, part, OIIO::ImageOutput::AppendSubimage));
  REQUIRE(out->write_image(TypeDesc::FLOAT, second));
  REQUIRE(out->close());
  const Loaded several = load(path);
  check_read(several.texture.texel(0, 0), {0.5f, 0.25f, 0});
  REQUIRE(several.notes.size() == 1);
  CHECK(contains(several.notes[0], "p.exr: has several parts, the first is taken"));
}

TEST_CASE("texels out of range are clamped with a note, those that are not finite an error",
          "[texture]") {
  const TempFolder folder;
  const ImageSpec spec(2, 2, 3, TypeDesc::FLOAT);
  std::vector<float> values(12, 0.5f);
  values[4] = -0.25f, values[6] = 2, values[9] = 1.0001f;
  const std::string path = write_picture(folder, "r.exr", spec, values);
  const Loaded colour = load(path), numbers = load(path, TextureUse::numbers),
               light = load(path, TextureUse::radiance);
  for (const Loaded* unit : {&colour, &numbers}) {
    CHECK(unit->texture.texel(1, 0) == Rgb(0.5f, 0, 0.5f));
    CHECK(unit->texture.texel(0, 1) == Rgb(1, 0.5f, 0.5f));
    CHECK(unit->texture.texel(1, 1).x == 1);
    REQUIRE(unit->notes.size() == 1);
    CHECK(unit->notes[0] == path +
                                ": 2 of 4 texels are outside [0, 1] and are clamped; the first "
                                "is (1, 0): 0.5 -0.25 0.5");
  }
  CHECK(light.texture.texel(1, 0) == Rgb(0.5f, 0, 0.5f));
  CHECK(light.texture.texel(0, 1) == Rgb(2, 0.5f, 0.5f));
  REQUIRE(light.notes.size() == 1);
  CHECK(contains(light.notes[0], "1 of 4 texels are below 0 and are clamped"));
  for (const float bad : {INFINITY, -INFINITY, std::nanf("")}) {
    values[7] = bad;
    CHECK(contains(refusal(write_picture(folder, "n.exr", spec, values)),
                   "n.exr: texel (0, 1) is not finite"));
  }
}

TEST_CASE("the rule for texels holds in scenes of every kind", "[texture][load]") {
  const TempFolder folder;
  write_picture(folder, "two.exr", ImageSpec(1, 1, 3, TypeDesc::HALF), {2, -1, 0.5f});
  folder.write("m.mtl", "newmtl m\nmap_Kd two.exr\nmap_Ke two.exr\n");
  const std::string scenes[] = {
      folder.write("s.json", R"({"materials": [{"name": "m", "reflectance_map": "two.exr",
          "emission_map": "two.exr"}], "shapes": [{"shape": "quad", "origin": [0,0,0],
          "u": [1,0,0], "v": [0,1,0], "material": "m"}]})"),
      folder.write("s.obj", "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
      folder.write("s.gltf", R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
          "images": [{"uri": "two.exr"}], "textures": [{"source": 0}],
          "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
                         "emissiveTexture": {"index": 0}, "emissiveFactor": [1, 1, 1]}],
          "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
          "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
          "bufferViews": [{"buffer": 0, "byteLength": 36}],
          "buffers": [{"byteLength": 36, "uri":
            "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"
          }]})")};
  for (const std::string& path : scenes) {
    CAPTURE(path);
    const Scene scene = load_scene(path);
    std::size_t unit = 0, light = 0;
    for (const std::string& warning : scene.warnings) {
      unit += contains(warning, "two.exr: 1 of 1 texels are outside [0, 1]");
      light += contains(warning, "two.exr: 1 of 1 texels are below 0");
    }
    CHECK(unit == 1);
    CHECK(light == 1);
    const Material& m = scene.materials.at(0);
    CHECK(scene.textures.at(static_cast<std::size_t>(m.reflectance_texture)).texel(0, 0) ==
          Rgb(1, 0, 0.5f));
    CHECK(scene.textures.at(static_cast<std::size_t>(m.emission_texture)).texel(0, 0) ==
          Rgb(2, 0, 0.5f));
  }
}

TEST_CASE("an environment that is no latitude-longitude picture by its shape is told",
          "[texture][load]") {
  const TempFolder folder;
  const std::string scene = folder.write("s.json", with_shapes(R"({"shape": "sphere",
      "center": [0,0,0], "radius": 1, "material": "white"})"));
  const auto notes = [&](int width, int height) {
    SceneOverrides overrides;
    overrides.sky_map =
        write_picture(folder, "e.exr", ImageSpec(width, height, 3, TypeDesc::HALF),
                      std::vector<float>(static_cast<std::size_t>(3 * width * height), 1.0f));
    const auto warnings = load_scene(scene, overrides).warnings;
    return std::count_if(warnings.begin(), warnings.end(), [](const std::string& warning) {
      return contains(warning, "s.json: the environment's picture of ");
    });
  };
  CHECK(notes(32, 16) == 0);
  CHECK(notes(1, 1) == 0);
  CHECK(notes(16, 16) == 1);  // a mirror ball
  CHECK(notes(64, 48) == 1);  // a cross
  CHECK(notes(8, 48) == 1);   // a strip of faces
}

}  // namespace
}  // namespace psf::render
