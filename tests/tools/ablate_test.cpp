// psf ablate as a program: its figures are those of psf filter and psf compare, iterations keep the
// energy, and psf report takes its folder.
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "catch.h"
#include "command.h"
#include "film/image.h"

using Study = nlohmann::json;
using psf::tests::Outcome;
using psf::tests::read_text;
using psf::tests::run;
using psf::tests::TempFolder;

namespace {

const std::string kSamples = PSF_SOURCE_DIR "/sample_data/";

void render(const TempFolder& folder, const std::string& scene, const std::string& options) {
  const Outcome outcome = run("psf-render " + kSamples + scene + ".json --quiet -o " +
                              folder / (scene + ".pvb ") + options);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
}

Study ablation(const TempFolder& folder, const std::string& options) {
  const Outcome outcome = run("psf ablate " + options + " --quiet --json " + folder / "a.json");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  return Study::parse(read_text(folder / "a.json"));
}

// As psf filter takes them.
std::string options_of(const Study& parameters) {
  std::string text;
  for (const auto& [name, value] : parameters.items()) {
    text += " --" + name + "=" + value.get<std::string>();
  }
  return text;
}

}  // namespace

TEST_CASE("A row of an ablation is what psf filter and psf compare give, and psf report shows it") {
  const TempFolder folder;
  render(folder, "cornell", "--passes 4 --size 40x30 --image " + folder / "before.exr");
  const std::string dump = folder / "cornell.pvb", reference = folder / "before.exr";
  const Study study = ablation(folder, dump + " --reference " + reference + " --r0 4px -o " +
                                           folder / "out" + " -o " + folder / "sheet.png");
  CHECK(study == Study::parse(read_text(folder / "out/ablate.json")));
  REQUIRE(study.at("rows").size() == 6 + 3 + 9);
  std::size_t filtered = 0;
  for (const Study& row : study.at("rows")) {
    const std::string picture = folder / ("out/" + row.at("picture").get<std::string>());
    const Outcome compared =
        run("psf compare " + picture + " " + reference + " --json " + folder / "c.json");
    REQUIRE(compared.code == 0);
    const Study figures = Study::parse(read_text(folder / "c.json")).at("rows").at(0).at("metrics");
    CHECK(row.at("metrics") == figures);
    if (row.at("parameters").is_null()) continue;
    ++filtered;
    const std::string passes = "0:" + std::to_string(row.at("passes").get<int>());
    REQUIRE(run("psf filter " + dump + " --quiet --layers none -o " + folder / "f.exr --passes " +
                passes + options_of(row.at("parameters")))
                .code == 0);
    INFO(row.at("label"));
    CHECK(psf::film::read_exr(picture).rgb() == psf::film::read_exr(folder / "f.exr").rgb());
  }
  CHECK(filtered == 16);
  CHECK(read_text(folder / "sheet.png").starts_with("\x89PNG"));

  const Outcome again = run("psf ablate " + dump + " -o " + folder / "out");
  CHECK(again.code == 2);
  CHECK(again.err.find("is there already; give another folder") != std::string::npos);
  const Outcome report = run("psf report " + folder / "out" + " -o " + folder / "r.html");
  CHECK(report.code == 0);
  CHECK(report.out.find("1 study, 19 pictures") != std::string::npos);
}

TEST_CASE("Eight iterations on one sample a pixel keep the energy to 1% on every sample scene") {
  const TempFolder folder;
  for (const std::string scene : {"arcade", "cornell", "corner", "fence", "furnace", "materials",
                                  "sphere-light", "textured", "two-rooms"}) {
    render(folder, scene,
           "--passes 1 --size 128x128" + std::string(scene == "corner" ? " --integrator ao" : ""));
    const Study study =
        ablation(folder, folder / (scene + ".pvb") + " -o " + folder / (scene + ".png"));
    std::size_t iterations = 0;
    for (const Study& row : study.at("rows")) {
      if (row.at("part") != "iterations" || row.at("parameters").is_null()) continue;
      ++iterations;
      INFO(scene << ", " << row.at("label") << ": " << row.at("change"));
      CHECK(std::abs(row.at("change").get<double>()) < 0.01);
    }
    CHECK(iterations == 8);
  }
}

TEST_CASE("An ablation says what it leaves out, and what is wrong, in one line") {
  const TempFolder folder;
  render(folder, "cornell", "--passes 1 --size 16x16 --channels normal,reflectance");
  const std::string verb = "psf ablate " + folder / "cornell.pvb";
  const Outcome lacking = run(verb + " -o " + folder / "s.png");
  CHECK(lacking.code == 0);
  CHECK(lacking.err.find("note: " + folder / "cornell.pvb" + ": has no channel visibility") == 0);
  CHECK(lacking.out.find("+ reflectance 0.05") != std::string::npos);
  CHECK(lacking.out.find("visibility") == std::string::npos);
  CHECK(lacking.out.find("1 block of 1 pass\n") == std::string::npos);  // figures follow
  CHECK(lacking.out.find("1 block of 1 pass ") != std::string::npos);
  const Outcome hash = run(verb + " --estimator hash -o " + folder / "h.png");
  CHECK(hash.code == 0);
  CHECK(hash.err.find("note: there are no iterations: --iterations: ") != std::string::npos);
  CHECK(hash.out.find("iteration 1") == std::string::npos);

  const auto refused = [&](const std::string& options, int code, const std::string& what) {
    const Outcome outcome = run(verb + " " + options);
    INFO(options << ": " << outcome.err);
    CHECK(outcome.code == code);
    CHECK(outcome.err.find(what) != std::string::npos);
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    CHECK(outcome.out.empty());
  };
  const std::string out = "-o " + folder / "x.png";
  refused("-o " + folder / "x.exr", 2, "write .png for a sheet");
  refused("-o " + folder / "x -o " + folder / "y", 2, "second folder");
  refused(out + " --visibility", 3, "visibility");
  refused(out + " --crop 0,0,17x4", 2, "--crop 0,0,17x4");
  refused(out + " --crop 4x4", 2, "write X,Y,WxH");
  refused(out + " --columns 0", 2, "--columns");
  refused(out + " --columns -1", 2, "--columns: expected a whole number of at least 1");
  refused(out + " --passes 1:2", 2, "1");
  refused(out + " --camera none", 2, "--camera");
  refused(out + " --metric magic", 2, "magic");
  refused(out + " --reference " + folder / "none.exr", 4, "none.exr");
  refused(out + " --max-memory 1K", 5, "--max-memory");
  CHECK_FALSE(std::filesystem::exists(folder / "x"));
  CHECK_FALSE(std::filesystem::exists(folder / "x.png"));
}

TEST_CASE(
    "A study that cannot be written to its end leaves nothing, and --json may lie in its folder") {
  const TempFolder folder;
  render(folder, "cornell", "--passes 2 --size 16x16 --image " + folder / "before.exr");
  const std::string dump = folder / "cornell.pvb",
                    reference = " --reference " + folder / "before.exr";
  const std::size_t files = folder.file_count();
  // Pictures fit below 10 kB, the table of all rows does not.
  const std::string confined = "sh -c 'trap \"\" XFSZ; ulimit -f 10; psf ";
  const std::string pictures = " --pictures --r0 1px,2px,3px,4px,5px,6px,7px,8px,9px,10px";
  for (const std::string& study :
       {"ablate " + dump + reference, "converge " + dump + reference + pictures}) {
    const Outcome full = run(confined + study + " -o " + folder / "new/study" + "'");
    INFO(study << ": " << full.err);
    CHECK(full.code == 4);
    CHECK(full.err.find("File too large") != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder / "new"));
    CHECK(folder.file_count() == files);
  }
  const std::string json = " --json " + folder / "out/copy.json";
  CHECK(run("psf ablate " + dump + " -o " + folder / "out/" + json).code == 0);
  CHECK(read_text(folder / "out/copy.json") == read_text(folder / "out/ablate.json"));
}
