// Dumps of several frames, from the renderer to pictures, as programs.
#include <string>

#include "catch.h"
#include "command.h"

using psf::tests::Outcome;
using psf::tests::read_text;
using psf::tests::TempFolder;

TEST_CASE("psf filter takes one frame of a sequence and refuses to mix them") {
  const TempFolder folder;
  const auto must = [](const std::string& command) {
    const Outcome outcome = psf::tests::run(command);
    INFO(command << "\n" << outcome.err);
    REQUIRE(outcome.code == 0);
    return outcome.out;
  };
  const std::string render = "psf-render " PSF_SOURCE_DIR
                             "/sample_data/lantern.json --size 32x24 --passes 2 --quiet --frames ";
  const std::string all = folder / "all.pvb", one = folder / "one.0004.pvb";
  must(render + "3:6 -o " + all);
  must(render + "3:6 -o " + (folder / "one.####.pvb"));

  const std::string info = must("psf info " + all);
  CHECK(info.find("frames      3:6, 2 passes each, cameras that move\n") != std::string::npos);

  const Outcome mixed = psf::tests::run("psf filter " + all + " -o " + (folder / "mixed.png"));
  CHECK(mixed.code == 2);
  CHECK(
      mixed.err.find(
          "has the frames 3:6, and passes 0:6 are of several, which would be mixed; choose one by "
          "--frame") != std::string::npos);
  CHECK(psf::tests::run("psf filter " + all + " --passes 1:3 -o " + (folder / "mixed.png")).code ==
        2);

  must("psf filter --quiet --frame 4 " + all + " -o " + (folder / "a.png"));
  must("psf filter --quiet --passes 2:4 " + all + " -o " + (folder / "b.png"));
  must("psf filter --quiet " + one + " -o " + (folder / "c.png"));
  CHECK(read_text(folder / "a.png") == read_text(folder / "c.png"));
  CHECK(read_text(folder / "b.png") == read_text(folder / "c.png"));

  const Outcome none = psf::tests::run("psf filter --frame 6 " + all + " -o " + (folder / "d.png"));
  CHECK(none.code == 2);
  CHECK(none.err.find("has the frames 3:6, 6 is none of them") != std::string::npos);
  for (const std::string& command : {"psf cat " + all + " --passes 2:4 -o " + (folder / "e.pvb"),
                                     "psf cat " + all + " " + all + " -o " + (folder / "e.pvb")}) {
    const Outcome cut = psf::tests::run(command);
    CHECK(cut.code == 2);
    CHECK(cut.err.find("cannot be joined with others, nor cut") != std::string::npos);
  }
}
