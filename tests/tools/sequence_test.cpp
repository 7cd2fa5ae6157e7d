// Dumps of several frames, from the renderer to pictures, as programs.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

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
          "--passes, 2 from 0, 2, ... on, or psf filter's --frame") != std::string::npos);
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

namespace {

// Three frames of a moving lamp, ball and camera, in one dump and in a dump each.
class Lantern {
 public:
  Lantern() {
    const std::string render = "psf-render " PSF_SOURCE_DIR
                               "/sample_data/lantern.json --size 32x24 --passes 2 --quiet "
                               "--channels default,rest_position --frames 3:6 -o ";
    must(render + in("all.pvb"));
    must(render + in("one.####.pvb"));
  }
  [[nodiscard]] std::string in(const std::string& name) const { return folder_ / name; }
  std::string must(const std::string& command) const {
    const Outcome outcome = psf::tests::run(command);
    INFO(command << "\n" << outcome.err);
    REQUIRE(outcome.code == 0);
    return outcome.out;
  }
  [[nodiscard]] std::string text(const std::string& name) const { return read_text(in(name)); }

 private:
  TempFolder folder_;
};

}  // namespace

TEST_CASE("psf filter writes a picture a frame, alone the bytes of --frame, of one dump or many") {
  const Lantern lantern;
  const std::string all = lantern.in("all.pvb"), many = lantern.in("one.####.pvb");
  lantern.must("psf filter --quiet " + all + " -o " + lantern.in("a.####.png") + " -o " +
               lantern.in("a.####.exr"));
  lantern.must("psf filter --quiet --window 1 " + all + " -o " + lantern.in("w.####.exr"));
  lantern.must("psf filter --quiet " + many + " -o " + lantern.in("m.####.png"));
  for (const char* frame : {"3", "4", "5"}) {
    const std::string number = std::string("000") + frame;
    lantern.must("psf filter --quiet --frame " + std::string(frame) + " " + all + " -o " +
                 lantern.in("f.####.png") + " -o " + lantern.in("f.####.exr"));
    CHECK(lantern.text("a." + number + ".png") == lantern.text("f." + number + ".png"));
    CHECK(lantern.text("m." + number + ".png") == lantern.text("f." + number + ".png"));
    CHECK(lantern.text("a." + number + ".exr") == lantern.text("f." + number + ".exr"));
    CHECK(lantern.text("w." + number + ".exr") == lantern.text("f." + number + ".exr"));
  }
}

TEST_CASE("psf filter --window gives the same bytes of one dump and many, and for any threads") {
  const Lantern lantern;
  const std::string all = lantern.in("all.pvb"), many = lantern.in("one.####.pvb");
  const std::string report =
      lantern.must("psf filter --quiet --window 3 " + all + " -o " + lantern.in("a.####.png"));
  CHECK(report.find("frames     3:6, window 3, relit 1.5, positions rest; ") != std::string::npos);
  lantern.must("psf filter --quiet --threads 1 --window 3 " + all + " -o " +
               lantern.in("t.####.png"));
  lantern.must("psf filter --quiet --window 3 " + many + " -o " + lantern.in("m.####.png"));
  lantern.must("psf filter --quiet --window 3 --frame 4 " + many + " -o " + lantern.in("f.png"));
  lantern.must("psf filter --quiet " + all + " -o " + lantern.in("alone.####.png"));
  for (const std::string frame : {"0003", "0004", "0005"}) {
    CHECK(lantern.text("a." + frame + ".png") == lantern.text("t." + frame + ".png"));
    CHECK(lantern.text("a." + frame + ".png") == lantern.text("m." + frame + ".png"));
    CHECK(lantern.text("a." + frame + ".png") != lantern.text("alone." + frame + ".png"));
  }
  CHECK(lantern.text("f.png") == lantern.text("a.0004.png"));
}

TEST_CASE("Options about frames that do not fit are named in one line") {
  const Lantern lantern;
  const std::string all = " " + lantern.in("all.pvb"), one = " " + lantern.in("one.0004.pvb");
  const std::string out = " -o " + lantern.in("x.png"), outs = " -o " + lantern.in("x.####.png");
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"psf filter --window 2" + all + outs, "--window 2: as many frames before as behind"},
      {"psf filter --window 0" + all + outs, "give an odd number"},
      {"psf filter --window 3" + all + out, "x.png: a picture a frame needs #### in its name"},
      {"psf filter --relit 2" + all + outs, "--relit: is about other frames; give --window K"},
      {"psf filter --window 3 --relit 0" + all + outs, "--relit: '0': write a number above 0"},
      {"psf filter --window 3 --positions here" + all + outs, "write rest or world"},
      {"psf filter --window 3 --plane 1" + all + outs, "give --plane off or --positions world"},
      {"psf filter --window 3 --iterations 2" + all + outs, "cannot be averaged again"},
      {"psf filter --window 3 --estimator hash" + all + outs, "only --estimator average"},
      {"psf filter --passes 0:2" + all + outs, "--passes: are of one frame"},
      {"psf filter --passes 0:1" + one + outs, "--passes: are of one frame"},
      {"psf filter --window 3 --frame 7" + one + out, "7 is none of them"}};
  for (const auto& [command, message] : wrong) {
    const Outcome outcome = psf::tests::run(command + " --quiet");
    INFO(command << "\n" << outcome.err);
    CHECK(outcome.code == 2);
    CHECK(outcome.err.find(message) != std::string::npos);
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  }
  lantern.must("psf cat" + all + " -o " + lantern.in("bare.pvb") + " --drop rest_position --quiet");
  const Outcome bare = psf::tests::run("psf filter --quiet --window 3 --positions rest " +
                                       lantern.in("bare.pvb") + outs);
  CHECK(bare.code == 3);
  CHECK(bare.err.find("has no channel rest_position") != std::string::npos);
  CHECK(psf::tests::run("psf filter --window 3 " + lantern.in("gone.####.pvb") + outs).code == 4);
}

TEST_CASE("psf flicker prints a row a sequence, and a sheet") {
  const Lantern lantern;
  lantern.must("psf filter --quiet " + lantern.in("all.pvb") + " -o " + lantern.in("a.####.exr"));
  lantern.must("psf filter --quiet --r0 0 " + lantern.in("all.pvb") + " -o " +
               lantern.in("b.####.exr"));
  const std::string a = lantern.in("a.####.exr"), b = lantern.in("b.####.exr");
  const std::string command = "psf flicker --quiet " + a + " " + b + " --reference " + a;
  const std::string text =
      lantern.must(command + " --frames 3:6 --label same --label other --sheet " +
                   lantern.in("s.png") + " --json " + lantern.in("f.json"));
  CHECK(text.find("           0           0  same\n") != std::string::npos);
  CHECK(text.find("  other\n") != std::string::npos);
  CHECK(lantern.text("s.png").starts_with("\x89PNG"));
  CHECK(lantern.text("f.json").find("\"label\": \"other\"") != std::string::npos);
  CHECK(psf::tests::run(command).code == 2);                    // there is no frame 0
  CHECK(psf::tests::run(command + " --frames 3:5").code == 2);  // too few
  CHECK(psf::tests::run(command + " --frames 3:7").code == 4);  // one is missing
  CHECK(psf::tests::run(command + " --frames 3:6 --label one").code == 2);
  const Outcome one =
      psf::tests::run("psf flicker " + a + " --reference " + lantern.in("a.0003.exr"));
  CHECK(one.code == 2);
  CHECK(one.err.find("a sequence has #### in its name") != std::string::npos);
}

TEST_CASE("psf flicker takes frames as other verbs take passes") {
  const Lantern lantern;
  lantern.must("psf filter --quiet " + lantern.in("all.pvb") + " -o " + lantern.in("a.####.exr"));
  const std::string a = lantern.in("a.####.exr");
  const std::string command = "psf flicker --quiet " + a + " --reference " + a + " --frames ";
  const std::string whole = lantern.must(command + "3:6");
  CHECK(whole.find("frames 3:6") != std::string::npos);
  CHECK(lantern.must(command + "3:") == whole);  // as far as the reference goes
  for (const auto& [frames, message] :
       {std::pair("3", "--frames: '3': write FIRST:LAST, LAST not included"),
        std::pair("a:6", "--frames: 'a' is no whole number"),
        std::pair("3:x", "--frames: 'x' is no whole number"),
        std::pair("3:5", "--frames: 3:5: flicker takes at least 3"),
        std::pair("6:3", "--frames: 6:3: flicker takes at least 3"),
        std::pair("5:", "from 5 on, and flicker takes at least 3"),
        std::pair("0:4294967296", "--frames: 4294967295 are the most"),
        std::pair("18446744073709551615:4", "--frames: 4294967295 are the most")}) {
    const Outcome outcome = psf::tests::run(command + frames);
    CAPTURE(frames, outcome.err);
    CHECK(outcome.code == 2);
    CHECK(outcome.err.find(message) != std::string::npos);
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  }
}
