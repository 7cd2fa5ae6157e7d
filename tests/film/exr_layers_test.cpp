// Layers are found by the names that programs give their channels.
#include "film/exr_layers.h"

#include "catch.h"
#include "core/error.h"

using psf::film::choose_layer;
using psf::film::exr_layers;
using psf::film::ExrLayer;
using psf::film::ExrPart;
using psf::film::LayerKind;

namespace {

std::vector<std::string> names_of(const std::vector<ExrLayer>& layers) {
  std::vector<std::string> names;
  for (const ExrLayer& layer : layers) names.push_back(layer.name);
  return names;
}

ExrLayer chosen(const std::vector<ExrPart>& parts, const std::string& name = "",
                const std::string& fallback = "") {
  return choose_layer("a.exr", exr_layers(parts), name, fallback, "`layer`");
}

// What is said where none can be chosen, with the exit code in front.
std::string refusal(const std::vector<ExrPart>& parts, const std::string& name = "") {
  try {
    (void)chosen(parts, name);
  } catch (const psf::Error& error) {
    return std::to_string(static_cast<int>(error.code())) + " " + error.what();
  }
  return "nothing";
}

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("the colours at the root are taken, whatever else there is") {
  const std::vector<ExrPart> ours = {{"",
                                      {"B", "G", "R", "albedo.B", "albedo.G", "albedo.R",
                                       "neighbors.Y", "normal.X", "normal.Y", "normal.Z"}}};
  CHECK(names_of(exr_layers(ours)) == Names{"", "albedo", "neighbors", "normal"});
  CHECK(chosen(ours).name.empty());
  CHECK(chosen(ours, "albedo.").channels[1] == "albedo.G");
  CHECK(chosen(ours, "normal").kind == LayerKind::vector);
  CHECK(chosen(ours, "neighbors").kind == LayerKind::grey);
  CHECK(refusal(ours, "depth") ==
        "3 a.exr: has no layer depth; its layers: (without a name), albedo, neighbors, normal");
}

TEST_CASE("the only colours are taken where none are at the root") {
  const ExrLayer blender =
      chosen({{"",
               {"ViewLayer.Combined.A", "ViewLayer.Combined.B", "ViewLayer.Combined.G",
                "ViewLayer.Combined.R", "ViewLayer.Depth.Z"}}});
  CHECK(blender.name == "ViewLayer.Combined");
  CHECK(blender.channels[0] == "ViewLayer.Combined.R");
  CHECK(blender.alpha == "ViewLayer.Combined.A");
  CHECK(chosen({{"", {"beauty.red", "beauty.green", "beauty.blue"}}}).name == "beauty");
  CHECK(chosen({{"", {"b", "g", "r", "Z"}}}).channels[0] == "r");
  // Grey layers do not count beside colours, nor vectors.
  CHECK(chosen({{"", {"Y", "beauty.B", "beauty.G", "beauty.R", "n.X", "n.Y", "n.Z"}}}).name ==
        "beauty");
  CHECK(chosen({{"", {"Y"}}}).kind == LayerKind::grey);
  CHECK(chosen({{"", {"depth.Y"}}}).name == "depth");
  CHECK(chosen({{"", {"BY", "RY", "Y"}}}).kind == LayerKind::chroma);
}

TEST_CASE("luminance and chroma have exact names, which OpenEXR reads alone") {
  CHECK(chosen({{"", {"a.BY", "a.RY", "a.Y"}}}).kind == LayerKind::chroma);
  CHECK(refusal({{"", {"by", "ry", "y"}}}) == "3 a.exr: has no channels R, G, B, nor Y");
  CHECK(refusal({{"", {"By", "RY", "Y"}}}) == "3 a.exr: has no channels R, G, B, nor Y");
}

TEST_CASE("a channel whose name ends in a dot is no component") {
  CHECK(refusal({{"", {"foo."}}}) == "3 a.exr: has no channels R, G, B, nor Y");
  CHECK(exr_layers({{"", {"foo.", "foo.x", "foo.z"}}}).empty());
}

TEST_CASE("where several layers would do they are listed") {
  const std::vector<ExrPart> two = {
      {"", {"beauty.B", "beauty.G", "beauty.R", "diffuse.B", "diffuse.G", "diffuse.R", "z.Y"}}};
  CHECK(refusal(two) ==
        "2 a.exr: has several layers that would do; give `layer` one of: beauty, diffuse");
  CHECK(chosen(two, "diffuse").name == "diffuse");
  CHECK(chosen(two, "", "diffuse").name == "diffuse");
  CHECK(refusal({{"", {"a.Y", "b.Y"}}}) ==
        "2 a.exr: has several layers that would do; give `layer` one of: a, b");
  CHECK(refusal({{"", {"Z", "id.id"}}}) == "3 a.exr: has no channels R, G, B, nor Y");
  CHECK(refusal({{"", {"Z"}}}, "x") == "3 a.exr: has no layer x, nor any other");
}

TEST_CASE("a layer of several parts bears its part's name where it has none of its own") {
  const std::vector<ExrPart> stereo = {{"left", {"B", "G", "R"}}, {"right", {"B", "G", "R", "A"}}};
  CHECK(names_of(exr_layers(stereo)) == Names{"left", "right"});
  CHECK(chosen(stereo, "right").part == 1);
  CHECK(refusal(stereo).find("left, right") != std::string::npos);
  CHECK(chosen({{"rgba", {"A", "B", "G", "R"}}, {"depth", {"Z"}}}).name == "rgba");
  const std::vector<ExrPart> twice = {{"one", {"d.B", "d.G", "d.R"}},
                                      {"two", {"d.B", "d.G", "d.R"}}};
  CHECK(names_of(exr_layers(twice)) == Names{"one.d", "two.d"});
}
