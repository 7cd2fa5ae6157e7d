// psf report as a command: exit codes, what it says, and that nothing half-written stays.
#include <filesystem>
#include <nlohmann/json.hpp>

#include "catch.h"
#include "command.h"
#include "report_sample.h"

using namespace psf::tests;

TEST_CASE("psf report writes one page of several folders and says what it left out") {
  const TempFolder folder;
  write_sample(folder / "radii", sample_sweep("room.json"));
  write_sample(folder / "rates", sample_converge("room.json"));
  const std::string all = "psf report " + folder / "radii" + " " + folder / "rates" + " -o " +
                          folder / "r.html --max-pictures 20 --json " + folder / "r.json";
  const Outcome done = run(all);
  CHECK(done.code == 0);
  CHECK(done.err.empty());
  CHECK(done.out.starts_with(folder / "r.html: 2 studies, 27 pictures, "));
  const auto figures = nlohmann::json::parse(read_text(folder / "r.json"));
  CHECK(figures["pictures"] == 27);
  CHECK(figures["pictures_left_out"] == 0);
  CHECK(figures["bytes"] == std::filesystem::file_size(folder / "r.html"));

  const std::string fewer =
      "psf report " + folder / "radii -o " + folder / "r.html --max-pictures 3";
  CHECK(run(fewer).err == "note: 11 pictures were left out, the worst ones; see --max-pictures\n");
  CHECK(run(fewer + " --quiet").err.empty());
}

TEST_CASE("psf report refuses in one line and leaves the page that was there") {
  const TempFolder folder;
  const std::string page = folder / "r.html";
  std::ofstream(page) << "before";
  const auto refused = [&](const std::string& arguments, int code) {
    const Outcome outcome = run("psf report " + arguments);
    INFO(arguments << ": " << outcome.err);
    CHECK(outcome.code == code);
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    CHECK(read_text(page) == "before");
    return outcome.err;
  };
  (void)refused("", 2);
  (void)refused(folder / "d", 2);
  (void)refused(folder / "d -o " + page, 4);
  Json sweep = sample_sweep("room.json");
  sweep["rows"][3].erase("metrics");
  write_json(folder / "d", sweep);
  CHECK(
      refused(folder / "d -o " + page, 3) ==
      "psf: " + folder / "d/sweep.json: /rows/3: expected \"metrics\" in it; write it anew with " +
          "psf sweep -o " + folder / "d" + "\n");
  write_json(folder / "d", sample_sweep("room.json"));
  (void)refused(folder / "d -o " + page, 4);  // the pictures are missing
  (void)refused(folder / "d -o " + folder / "none/r.html", 4);
  CHECK(folder.file_count() == 2);
  CHECK(run("psf report " + folder / "d -o " + page + " --max-pictures 0").code == 0);
}
