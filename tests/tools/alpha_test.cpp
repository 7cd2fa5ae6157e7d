// Alpha from the renderer to a picture with the background apart, as programs.
#include <algorithm>
#include <string>
#include <vector>

#include "catch.h"
#include "command.h"
#include "film/image.h"

using psf::tests::Outcome;
using psf::tests::read_text;
using psf::tests::TempFolder;

namespace {

// A fence before a wall and the sky, with alpha and without.
class Yard {
 public:
  Yard() {
    for (const std::string name : {"a", "b"}) {
      const std::string channels = name == "a" ? " --channels default,alpha" : "";
      must("psf-render " PSF_SOURCE_DIR
           "/sample_data/fence.json --size 40x30 --passes 2 --quiet "
           "--eye 6,1.2,9 --target 0,1.2,0 --fov 50 --layers lights -o " +
           path(name + ".pvb") + channels);
      must("psf filter --quiet " + path(name + ".pvb") + " -o " + path(name + ".exr") + " -o " +
           path(name + ".png"));
    }
  }
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }
  std::string must(const std::string& command) const {
    const Outcome outcome = psf::tests::run(command);
    INFO(command << "\n" << outcome.err);
    REQUIRE(outcome.code == 0);
    return outcome.out;
  }

 private:
  TempFolder folder_;
};

}  // namespace

TEST_CASE("With alpha a render has the same PNG and the same errors, and A in its EXR") {
  const Yard yard;
  const psf::film::Image a = psf::film::read_exr(yard.path("a.exr")),
                         b = psf::film::read_exr(yard.path("b.exr"));
  REQUIRE(a.find("A") != nullptr);
  CHECK(b.find("A") == nullptr);
  const std::vector<float>& alpha = *a.find("A");
  CHECK(*std::min_element(alpha.begin(), alpha.end()) == 0);
  CHECK(*std::max_element(alpha.begin(), alpha.end()) == 1);
  CHECK(a.rgb() != b.rgb());
  CHECK(read_text(yard.path("a.png")) == read_text(yard.path("b.png")));
  for (const char* layer : {"", " --layer unfiltered-input --reference-layer unfiltered-input"}) {
    yard.must("psf compare " + yard.path("a.exr") + " " + yard.path("b.exr") +
              " --metric relMSE --max 1e-12" + layer);
  }
}

TEST_CASE("The background is a row of psf relight, and gone where its weight is 0") {
  const Yard yard;
  const std::string out =
      yard.must("psf relight " + yard.path("a.exr") + " background=0 -o " + yard.path("c.exr"));
  CHECK(out.find("background") != std::string::npos);
  const psf::film::Image a = psf::film::read_exr(yard.path("a.exr")),
                         c = psf::film::read_exr(yard.path("c.exr"));
  CHECK(c.seen() == c.rgb());
  CHECK(*c.find("A") == *a.find("A"));
  const std::vector<psf::Rgb> before = a.rgb(), after = c.rgb();
  float off = 0;  // it adds the layers up anew
  for (std::size_t pixel = 0; pixel < before.size(); ++pixel) {
    off = std::max(off, (after[pixel] - before[pixel]).length());
  }
  CHECK(off < 1e-6f);
}

TEST_CASE("psf filter --layers says with or without alpha, and what a dump without it lacks") {
  const Yard yard;
  const std::string filter = "psf filter --quiet " + yard.path("a.pvb") + " -o ";
  yard.must(filter + yard.path("c.exr") + " --layers alpha");
  yard.must(filter + yard.path("d.exr") + " --layers none");
  CHECK(psf::film::read_exr(yard.path("c.exr")).layers.size() == 7);
  CHECK(psf::film::read_exr(yard.path("d.exr")).rgb() ==
        psf::film::read_exr(yard.path("b.exr")).rgb());
  const Outcome refused = psf::tests::run("psf filter " + yard.path("b.pvb") + " -o " +
                                          yard.path("e.exr") + " --layers alpha");
  CHECK(refused.code == 3);
  CHECK(refused.err.find("has no channel alpha") != std::string::npos);
}
