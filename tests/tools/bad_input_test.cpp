// What a stranger does wrong: one clear line each, the right exit code, nothing half-written.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "catch.h"
#include "command.h"

namespace fs = std::filesystem;
using psf::tests::Outcome;
using psf::tests::run;
using psf::tests::TempFolder;

namespace {

struct Mistake {
  std::string command;  // FOLDER is the test's folder, SAMPLES that of the sample data
  int code;
  std::string message;  // part of the one line on stderr
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

// Folder of the test with a few files to go wrong with.
class Workplace {
 public:
  Workplace() {
    write("malformed.json", "{\"shapes\": [}");
    write("empty.json", "{}");
    write("no_picture.json", scene("[0, 0, 0]", "\"reflectance_map\": \"nowhere.png\""));
    write("unknown_key.json", scene("[0, 0, 0]", "\"reflectence\": 0.5"));
    write("nan.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n");
    write("degenerate.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n");
    write("broken.png", std::string("\x89PNG\r\n\x1a\n") + std::string(40, '\0'));
    write("broken_picture.json", scene("[0, 0, 0]", "\"reflectance_map\": \"broken.png\""));
    write("far.obj", "v 1e9 0 0\nv 1000000008 0 0\nv 1e9 8 0\nf 1 2 3\n");
    write("scene.xyz", "");
    write("text.pvb", "this is no dump");
    render("good.pvb", "");
    fs::copy_file(folder_ / "good.pvb", folder_ / "cut.pvb");
    fs::resize_file(folder_ / "cut.pvb", fs::file_size(folder_ / "good.pvb") / 3);
    render("lacking.pvb", "--channels normal,reflectance");
    render("tables.pvb", "--vertices 2 --photons 100");
    render("grey.pvb", "--image " + (folder_ / "grey.exr"));
  }
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_.path())) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }
  // Bytes after the last commit, as a killed writer leaves them.
  void add_tail(const std::string& name) const {
    std::ofstream(folder_ / name, std::ios::app) << std::string(5000, '\x89');
  }
  [[nodiscard]] Outcome make(const Mistake& mistake) const {
    return run(replaced(replaced(mistake.command, "FOLDER", folder_.path().string()), "SAMPLES/",
                        samples()));
  }

 private:
  static std::string samples() { return PSF_SOURCE_DIR "/sample_data/"; }
  static std::string scene(const std::string& center, const std::string& material) {
    return "{\"materials\": [{\"name\": \"m\", \"kind\": \"diffuse\", " + material +
           "}], \"shapes\": [{\"shape\": \"sphere\", \"center\": " + center +
           ", \"radius\": 1, \"material\": \"m\"}]}";
  }
  void render(const std::string& name, const std::string& options) {
    const std::string command = "psf-render SAMPLES/cornell.json --size 16x16 --passes 2 --quiet ";
    const Outcome outcome = make({command + "-o FOLDER/" + name + " " + options, 0, ""});
    REQUIRE(outcome.code == 0);
  }
  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
  }

  TempFolder folder_;
};

}  // namespace

TEST_CASE("every mistake is one line, has its exit code and leaves nothing behind") {
  const Workplace workplace;
  const std::vector<std::string> before = workplace.files();
  const std::vector<Mistake> mistakes = {
      // scenes
      {"psf-render FOLDER/nowhere.json -o FOLDER/x.pvb", 4, "nowhere.json: no such file"},
      {"psf-render FOLDER/scene.xyz -o FOLDER/x.pvb", 3, ".xyz"},
      {"psf-render FOLDER/malformed.json -o FOLDER/x.pvb", 3,
       "malformed.json:1:13: malformed JSON"},
      {"psf-render FOLDER/empty.json -o FOLDER/x.pvb", 3, "empty.json: "},
      {"psf-render FOLDER/unknown_key.json -o FOLDER/x.pvb", 3,
       "/materials/0: unknown key \"reflectence\"; did you mean \"reflectance\"?"},
      {"psf-render FOLDER/no_picture.json -o FOLDER/x.pvb", 4, "nowhere.png"},
      {"psf-render FOLDER/nan.obj -o FOLDER/x.pvb", 3, "nan.obj:3: vertex 3 is not finite"},
      // what psf-render is asked for
      {"psf-render SAMPLES/cornell.json", 2, "nothing to write"},
      {"psf-render SAMPLES/cornell.json -o FOLDER/x.pvb --size 0x10", 2, "--size"},
      {"psf-render SAMPLES/cornell.json -o FOLDER/x.pvb --passes 0", 2, "--passes"},
      {"psf-render SAMPLES/cornell.json -o FOLDER/x.pvb --eye 1,2", 2, "--eye"},
      {"psf-render SAMPLES/cornell.json -o FOLDER/x.pvb --pases 2", 2, "unknown option --pases"},
      {"psf-render SAMPLES/cornell.json -o FOLDER/x.pvb --camera left", 2, "its cameras: front"},
      {"psf-render SAMPLES/cornell.json -o FOLDER/x.pvb --integrator bdpt", 2, "path"},
      {"psf-render SAMPLES/cornell.json -o FOLDER/nowhere/x.pvb", 4,
       "does not exist, create it first"},
      {"psf-render SAMPLES/cornell.json --image FOLDER/x.jpg", 2, "use .exr or .png"},
      // dumps
      {"psf filter FOLDER/nowhere.pvb -o FOLDER/x.exr", 4, "nowhere.pvb: "},
      {"psf filter FOLDER/text.pvb -o FOLDER/x.exr", 3, "is no path-vertex buffer"},
      {"psf filter FOLDER/cut.pvb -o FOLDER/x.exr", 3, "cut.pvb: "},
      {"psf filter FOLDER/lacking.pvb -o FOLDER/x.exr --visibility", 3,
       "has no channel visibility, which --visibility needs; render a dump that has it, or give "
       "--visibility=off"},
      {"psf info FOLDER/text.pvb", 3, "is no path-vertex buffer"},
      {"psf verify FOLDER/nowhere.pvb", 4, "nowhere.pvb: "},
      // what psf is asked for
      {"psf", 2, "see psf --help"},
      {"psf fliter FOLDER/good.pvb", 2, "there is no verb fliter"},
      {"psf filter FOLDER/good.pvb", 2, "--output is required"},
      {"psf filter FOLDER/good.pvb -o FOLDER/x.exr --radus 1", 2, "unknown option --radus"},
      {"psf filter FOLDER/good.pvb -o FOLDER/x.exr --r0 8furlong", 2,
       "--r0: '8furlong' is no radius"},
      {"psf filter FOLDER/good.pvb -o FOLDER/x.exr --delta 1", 2, "--delta"},
      {"psf filter FOLDER/good.pvb -o FOLDER/x.exr --block 1^4", 2, "--block"},
      {"psf filter FOLDER/good.pvb -o FOLDER/x.exr --normal 3", 2, "--normal"},
      {"psf filter FOLDER/good.pvb -o FOLDER/x.exr --passes 1:9", 2, "has passes 0:2"},
      {"psf filter FOLDER/good.pvb -o FOLDER/nowhere/x.exr", 4, "does not exist, create it first"},
      {"psf filter FOLDER/good.pvb -o FOLDER/x.jpg", 2, "use .exr or .png"},
      {"psf filter FOLDER/good.pvb -o FOLDER/x.exr --follow --snapshots pow2", 2, "--follow"},
      // what is said before an error is not said
      {"psf filter FOLDER/lacking.pvb -o FOLDER/x.jpg", 2, "use .exr or .png"},
      {"psf tune FOLDER/lacking.pvb --json FOLDER/nowhere/x.json", 4, "does not exist"},
      {"psf sweep FOLDER/lacking.pvb --reference FOLDER/grey.exr --r0 4px -o FOLDER/x --json "
       "FOLDER/nowhere/x.json",
       4, "does not exist"},
      {"psf converge FOLDER/lacking.pvb --reference FOLDER/grey.exr --r0 4px -o FOLDER/x --json "
       "FOLDER/nowhere/x.json",
       4, "does not exist"},
      {"psf-render FOLDER/broken_picture.json --image FOLDER/x.exr", 3, "cannot read the picture"},
      {"psf-render FOLDER/far.obj -o FOLDER/x.pvb --sky 1", 5, "would all be in one place"},
      // tables
      {"psf-render SAMPLES/cornell.json -o FOLDER/x.pvb --vertices 0", 2,
       "--vertices: expected all"},
      {"psf filter FOLDER/good.pvb -o FOLDER/x.exr --vertex depth:1", 3,
       "has no vertices to choose from; render with --vertices all"},
      {"psf filter FOLDER/tables.pvb -o FOLDER/x.exr --vertex depth:x", 2,
       "--vertex: expected first-rough, depth:K"},
      {"psf filter FOLDER/tables.pvb -o FOLDER/x.exr --vertex depth:1 --visibility", 3,
       "the vertices of depth:1 have no channel visibility, which --visibility needs; choose "
       "first-rough, or give --visibility=off"},
      {"psf filter FOLDER/good.pvb -o FOLDER/x.exr --estimator density", 3,
       "has no photons, which --estimator density needs; render with --photons N"},
      {"psf export FOLDER/tables.pvb --table lights -o FOLDER/x.csv", 3,
       "has no table lights; it has paths, vertices, photons"},
      {"psf export FOLDER/tables.pvb --table photons -o FOLDER/x.csv --channels colour", 3,
       "tables.pvb: table photons: has no channel colour; it has path, position, "},
      {"psf cat FOLDER/good.pvb FOLDER/tables.pvb -o FOLDER/x.pvb", 3,
       "it has a table vertices, which the other has not; 'psf cat --drop' leaves tables out"},
      // counts
      {"psf filter FOLDER/good.pvb -o FOLDER/x.exr --threads -1", 2,
       "--threads: expected a whole number from 0 to 4096, got \"-1\""},
      {"psf-render SAMPLES/cornell.json -o FOLDER/x.pvb --threads 99999999999", 2, "--threads"},
      {"psf explain FOLDER/good.pvb --pixel 0,0 --top -1", 2, "--top: expected a whole number"},
      {"psf report FOLDER -o FOLDER/x.html --max-pictures -1", 2, "--max-pictures: expected"},
      // stopping, saving, joining
      {"psf-render SAMPLES/cornell.json --image FOLDER/x.exr --resume", 2, "give -o OUT.pvb"},
      {"psf-render SAMPLES/cornell.json -o FOLDER/text.pvb --resume", 3, "is no path-vertex"},
      {"psf-render SAMPLES/cornell.json -o FOLDER/good.pvb --resume --quiet", 3, "another scene"},
      {"psf-render SAMPLES/cornell.json --size 16x16 --seed 1 -o FOLDER/good.pvb --resume --quiet",
       3, "it was rendered with seed 0, now it is 1"},
      {"psf recover FOLDER/good.pvb", 2, "OUT is required"},
      {"psf recover FOLDER/good.pvb FOLDER/good.pvb", 2, "would overwrite the input"},
      {"psf recover FOLDER/text.pvb FOLDER/x.pvb", 3, "nothing can be saved"},
      {"psf recover FOLDER/nowhere.pvb FOLDER/x.pvb", 4, "nowhere.pvb: "},
      {"psf recover FOLDER/good.pvb FOLDER/nowhere/x.pvb", 4, "nowhere/x.pvb"},
      {"psf cat FOLDER/good.pvb", 2, "--output is required"},
      {"psf cat FOLDER/good.pvb FOLDER/lacking.pvb -o FOLDER/x.pvb", 3, "it has other channels"},
      {"psf cat FOLDER/good.pvb FOLDER/text.pvb -o FOLDER/x.pvb", 3, "is no path-vertex buffer"},
      {"psf cat FOLDER/good.pvb -o FOLDER/x.pvb --drop pixel", 2, "cannot be dropped"},
      {"psf cat FOLDER/good.pvb -o FOLDER/x.pvb --drop pixle", 3, "has no channel pixle"},
      {"psf cat FOLDER/good.pvb -o FOLDER/x.pvb --quantize flags", 2, "only f32"},
      {"psf cat FOLDER/good.pvb -o FOLDER/x.pvb --passes 2:3", 2, "passes 2:3 are no part"},
      {"psf cat FOLDER/good.pvb -o FOLDER/x.pvb --codec lz4", 2, "--codec"},
  };
  for (const Mistake& mistake : mistakes) {
    const Outcome outcome = workplace.make(mistake);
    INFO(mistake.command << "\n" << outcome.err);
    CHECK(outcome.code == mistake.code);
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    CHECK(outcome.err.find(mistake.message) != std::string::npos);
    CHECK(outcome.out.empty());
    CHECK(workplace.files() == before);
  }
}

TEST_CASE("a degenerate triangle is left out, counted, and the rest is rendered") {
  const Workplace workplace;
  const Outcome outcome = workplace.make(
      {"psf-render FOLDER/degenerate.obj --size 8x8 --passes 1 -o FOLDER/x.pvb", 0, ""});
  CHECK(outcome.code == 0);
  CHECK(outcome.err.find("degenerate") != std::string::npos);
}

TEST_CASE("a dump whose writer was killed is filtered up to its last commit") {
  const Workplace workplace;
  workplace.add_tail("good.pvb");
  const Outcome outcome =
      workplace.make({"psf filter FOLDER/good.pvb -o FOLDER/x.exr --quiet", 0, ""});
  CHECK(outcome.code == 0);
  CHECK(outcome.out.find("512 in 2 passes") != std::string::npos);
}

TEST_CASE("every verb has a help with an example") {
  for (const std::string command :
       {"psf", "psf filter", "psf info", "psf verify", "psf recover", "psf cat", "psf compare",
        "psf flicker", "psf export", "psf sweep", "psf converge", "psf tune", "psf ablate",
        "psf explain", "psf report", "psf-render"}) {
    const Outcome outcome = run(command + " --help");
    CHECK(outcome.code == 0);
    CHECK(outcome.out.find("Example:\n  " + command.substr(0, command.find(' '))) !=
          std::string::npos);
    CHECK(outcome.err.empty());
  }
}
