// psf compare as a user meets it.
#include "catch.h"
#include "command.h"
#include "film/image.h"

using psf::tests::Outcome;
using psf::tests::run;
using psf::tests::TempFolder;

namespace {

void write_grey(const std::string& path, std::size_t width, float value) {
  psf::film::Image image;
  image.width = width;
  image.height = 2;
  image.add("", "RGB", std::vector<float>(width * 2 * 3, value));
  psf::film::write_exr(path, image);
}

}  // namespace

TEST_CASE("compare prints the errors and turns --max into an exit code") {
  const TempFolder folder;
  const std::string a = folder / "a.exr", b = folder / "b.exr";
  write_grey(a, 4, 1.5f);
  write_grey(b, 4, 1);
  const Outcome outcome = run("psf compare " + a + " " + b);
  CHECK(outcome.code == 0);
  CHECK(outcome.err.empty());
  CHECK(outcome.out == "relMSE 0.247525  (epsilon 0.01)\nMSE    0.25\nPSNR   6.02 dB\n");
  CHECK(run("psf compare " + a + " " + b + " --max 0.25").code == 0);
  const Outcome above = run("psf compare " + a + " " + b + " --max 0.2");
  CHECK(above.code == 1);
  CHECK(above.err == "psf: " + a + ": relmse 0.247525 is above 0.2\n");
}

TEST_CASE("a picture that is not a number never passes") {
  const TempFolder folder;
  write_grey(folder / "a.exr", 4, NAN);
  write_grey(folder / "b.exr", 4, 1);
  CHECK(run("psf compare " + (folder / "a.exr") + " " + (folder / "b.exr") + " --max 1").code == 1);
}

TEST_CASE("compare tells wrong input in one line with the right code") {
  const TempFolder folder;
  const std::string a = folder / "a.exr", b = folder / "b.exr";
  write_grey(a, 4, 1);
  write_grey(b, 5, 1);
  const Outcome size = run("psf compare " + a + " " + b);
  CHECK(size.code == 3);
  CHECK(size.err == "psf: " + a + ": is 4x2, but " + b + " is 5x2; compare pictures of one size\n");
  CHECK(run("psf compare " + a + " nowhere.exr").code == 4);
  CHECK(run("psf compare " + a + " " + a + " --layer albedo").err ==
        "psf: " + a + ": has no channel albedo.R\n");
  const Outcome option = run("psf compare " + a + " " + a + " --maximum 1");
  CHECK(option.code == 2);
  CHECK(std::count(option.err.begin(), option.err.end(), '\n') == 1);
  CHECK(option.err.find("--maximum") != std::string::npos);
}
