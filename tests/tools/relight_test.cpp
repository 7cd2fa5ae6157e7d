// Layers of the light from the renderer to a relit picture, as programs.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "catch.h"
#include "command.h"
#include "film/image.h"

using psf::tests::Outcome;
using psf::tests::read_text;
using psf::tests::TempFolder;

namespace {

class Work {
 public:
  explicit Work(const std::string& scene, const std::string& layers) {
    must("psf-render " PSF_SOURCE_DIR "/sample_data/" + scene +
         " --size 40x30 --passes 2 --quiet "
         "--layers " +
         layers + " -o IN.pvb");
    must("psf filter IN.pvb -o IN.exr --quiet");
  }
  // "IN.pvb" and the like are files of the folder.
  [[nodiscard]] Outcome run(std::string command) const {
    for (const std::string name : {"IN.", "OUT."}) {
      for (std::size_t at = 0; (at = command.find(name, at)) != std::string::npos;) {
        command.replace(at, name.size(), folder_ / name);
        at += (folder_ / name).size();
      }
    }
    return psf::tests::run(command);
  }
  void must(const std::string& command) const {
    const Outcome outcome = run(command);
    INFO(command << "\n" << outcome.err);
    REQUIRE(outcome.code == 0);
  }
  [[nodiscard]] psf::film::Image image(const std::string& name) const {
    return psf::film::read_exr(folder_ / name);
  }
  [[nodiscard]] nlohmann::json json(const std::string& name) const {
    return nlohmann::json::parse(read_text(folder_ / name));
  }

 private:
  TempFolder folder_;
};

bool is_near(const std::vector<psf::Rgb>& a, const std::vector<psf::Rgb>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t pixel = 0; pixel < a.size(); ++pixel) {
    for (int c = 0; c < 3; ++c) {
      if (!(std::abs(a[pixel][c] - b[pixel][c]) <= 1e-6f * std::abs(b[pixel][c]) + 1e-12f)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

TEST_CASE("Layers of a render add up to the filtered picture and to its input") {
  using Names = std::vector<std::string>;
  for (const auto& [scene, layers, names] :
       {std::tuple("arcade.json", "lights", Names{"sun", "sky"}),
        std::tuple("cornell.json", "bounces", Names{"direct", "indirect", "camera"}),
        std::tuple("materials.json", "lobes", Names{"diffuse", "glossy", "camera"})}) {
    const Work work(scene, layers);
    const psf::film::Image image = work.image("IN.exr");
    for (const std::string prefix : {"", "unfiltered-input."}) {
      std::vector<psf::Rgb> sum(image.width * image.height, psf::Rgb(0));
      for (const std::string& name : names) {
        const std::vector<psf::Rgb> layer = image.rgb(prefix + name + ".");
        for (std::size_t pixel = 0; pixel < sum.size(); ++pixel) sum[pixel] += layer[pixel];
      }
      INFO(scene << " " << prefix);
      CHECK(is_near(sum, image.rgb(prefix)));
    }
  }
}

TEST_CASE("psf relight weighs the lights, says what they are, and can be undone") {
  const Work work("arcade.json", "lights");
  work.must("psf relight IN.exr sun=0 sky=2,1,0.5 -o OUT.exr -o OUT.png --json OUT.json");
  const psf::film::Image day = work.image("IN.exr"), night = work.image("OUT.exr");
  const std::vector<psf::Rgb> sky = day.rgb("sky.");
  for (std::size_t pixel = 0; pixel < sky.size(); ++pixel) {
    CHECK(night.rgb()[pixel] == sky[pixel] * psf::Rgb(2, 1, 0.5f));
  }
  const nlohmann::json told = work.json("OUT.json");
  CHECK(told.at("layers").size() == 2);
  CHECK(told.at("layers")[0].at("layer") == "sun");
  CHECK(told.at("layers")[0].at("share") == 0.0);
  CHECK(told.at("layers")[1].at("weight") == std::vector<double>{2, 1, 0.5});
  const std::string text = work.run("psf relight IN.exr").out;
  CHECK(text.find("sun") != std::string::npos);
  CHECK(text.find("wrote") == std::string::npos);
  work.must("psf relight IN.exr sun=4 -o OUT.bright.exr");
  work.must("psf relight OUT.bright.exr sun=0.25 -o OUT.again.exr");
  CHECK(is_near(work.image("OUT.again.exr").rgb(), day.rgb()));
}

TEST_CASE("psf filter writes the layers of the light that --layers names") {
  const Work work("arcade.json", "lights");
  const auto channels = [&](const std::string& layers) {
    work.must("psf filter IN.pvb -o OUT.exr --quiet --layers " + layers);
    return work.image("OUT.exr").layers.size();
  };
  CHECK(channels("all") == 14 + 12);
  CHECK(channels("none") == 3);
  CHECK(channels("sky") == 6);
  CHECK(channels("unfiltered-input,sky") == 12);
  const Outcome refused = work.run("psf filter IN.pvb -o OUT.exr --layers moon");
  CHECK(refused.code == 2);
  CHECK(refused.err.find("normal, alpha, fireflies, sun, sky") != std::string::npos);
  CHECK(channels("fireflies --fireflies spread") == 6);
  CHECK(work.run("psf filter IN.pvb -o OUT.exr --layers fireflies").code == 2);
}

TEST_CASE("A light of any name goes from the scene to the relit picture") {
  const TempFolder folder;
  const std::string name(60, 'n');
  std::ofstream(folder / "room.json") << R"({
    "cameras": [{"name": "one", "eye": [0, 1, 4], "target": [0, 1, 0], "fov": 50, "size": [16, 12]}],
    "materials": [{"name": "grey", "kind": "diffuse", "reflectance": 0.5}],
    "environment": {"radiance": 1},
    "lights": [{"kind": "point", "name": ")" +
                                             name + R"(", "position": [1, 3, 2], "intensity": 9},
               {"kind": "point", "name": "-all of it, 100%=", "position": [-1, 3, 2], "intensity": 2}],
    "shapes": [{"shape": "sphere", "center": [0, 1, 0], "radius": 1, "material": "grey"}]})";
  const std::string layer = name.substr(0, 40);
  for (const std::string& command :
       {"psf-render " + (folder / "room.json") + " -o " + (folder / "a.pvb") +
            " --layers lights --passes 2 --quiet",
        "psf filter " + (folder / "a.pvb") + " -o " + (folder / "a.exr") + " --quiet",
        "psf relight " + (folder / "a.exr") + " " + layer + "=0 _all_of_it__100__=0 -o " +
            (folder / "sky.exr")}) {
    const Outcome outcome = psf::tests::run(command);
    INFO(command << "\n" << outcome.err);
    REQUIRE(outcome.code == 0);
  }
  const psf::film::Image sky = psf::film::read_exr(folder / "sky.exr");
  CHECK(is_near(sky.rgb(), sky.rgb("sky.")));
}

TEST_CASE("Of a picture with some of the layers the other light stays") {
  const Work work("arcade.json", "lights");
  work.must("psf filter IN.pvb -o IN.sky.exr --layers sky,sky --quiet");
  work.must("psf relight IN.sky.exr sky=1 -o OUT.exr");
  CHECK(work.image("OUT.exr").rgb() == work.image("IN.exr").rgb());
  work.must("psf relight IN.sky.exr sky=0 -o OUT.exr");
  const auto sun = work.image("IN.exr").rgb("sun."), rest = work.image("OUT.exr").rgb();
  for (std::size_t pixel = 0; pixel < sun.size(); ++pixel) {
    for (int c = 0; c < 3; ++c) {
      CHECK(std::abs(sun[pixel][c] - rest[pixel][c]) <=
            1e-6f * work.image("IN.exr").rgb()[pixel][c] + 1e-9f);
    }
  }
}

TEST_CASE("psf filter says which layers there are, what they share, and what they lack") {
  const Work work("arcade.json", "lights");
  const auto said = [&](const std::string& options) {
    const Outcome outcome = work.run("psf filter IN.pvb -o OUT.exr --json OUT.json " + options);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    const std::size_t at = outcome.out.find("layers     ");
    return at == std::string::npos ? "" : outcome.out.substr(at, outcome.out.find('\n', at) - at);
  };
  CHECK(said("") == "layers     sun, sky");
  CHECK(work.json("OUT.json").at("layers") == std::vector<std::string>{"sun", "sky"});
  CHECK(said("--layers none").empty());
  CHECK(said("--layers sun") == "layers     sun");
  CHECK(said("--estimator adaptive") == "layers     sun, sky; with the radii of all light");
  CHECK(said("--estimator control --sources 1/2") ==
        "layers     sun, sky; with the beta of all light");
  work.must("psf cat IN.pvb -o IN.less.pvb --drop contribution.sky,unfiltered.sky --quiet");
  const Outcome less = work.run("psf filter IN.less.pvb -o OUT.exr");
  CHECK(less.out.find("layers     sun; they are off the picture by ") != std::string::npos);
}

TEST_CASE("What psf relight cannot do is one line that says what to write") {
  const Work work("arcade.json", "lights");
  work.must("psf filter IN.pvb -o IN.plain.exr --layers none --quiet");
  for (const auto& [options, code, part] :
       {std::tuple("IN.exr moon=2 -o OUT.exr", 2, "there are sun, sky"),
        std::tuple("IN.exr sun -o OUT.exr", 2, "write LAYER=W or LAYER=R,G,B"),
        std::tuple("IN.exr sun=1,2 -o OUT.exr", 2, "'sun=1,2' is no weight"),
        std::tuple("IN.exr sun=1 sun=2 -o OUT.exr", 2, "given twice"),
        std::tuple("IN.exr sun=nan -o OUT.exr", 2, "is no weight"),
        std::tuple("IN.exr sun=1 -o IN.exr", 2, "IN.exr"),
        std::tuple("IN.exr sun=1 -o OUT.jpg", 2, "OUT.jpg"),
        std::tuple("IN.plain.exr sun=1 -o OUT.exr", 3, "psf-render --layers"),
        std::tuple("IN.none.exr sun=1 -o OUT.exr", 4, "IN.none.exr")}) {
    const Outcome refused = work.run(std::string("psf relight ") + options);
    INFO(options << "\n" << refused.err);
    CHECK(refused.code == code);
    CHECK(refused.err.find(part) != std::string::npos);
    CHECK(std::count(refused.err.begin(), refused.err.end(), '\n') == 1);
  }
}
