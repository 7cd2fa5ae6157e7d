// The programs stop and go: killed, interrupted, timed out, followed; and damage, joined parts.
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "catch.h"
#include "command.h"
#include "film/image.h"

namespace fs = std::filesystem;
using psf::tests::Outcome;
using psf::tests::read_text;
using psf::tests::run;
using psf::tests::TempFolder;

namespace {

const std::string kScene = PSF_SOURCE_DIR "/sample_data/cornell.json --size 64x64 --quiet ";

// All values of a dump: its columns in raw and nothing else, by way of psf export.
std::string values_of(const TempFolder& folder, const std::string& dump) {
  const std::string out = folder / "values";
  fs::remove_all(out);
  REQUIRE(run("psf export " + folder / dump + " -o " + out + " --format npy --quiet").code == 0);
  std::string all;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(out)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    if (file.extension() == ".npy") all += file.filename().string() + read_text(file.string());
  }
  REQUIRE(all.size() > 1000);
  return all;
}

bool same_picture(const std::string& a, const std::string& b) {
  return psf::film::read_exr(a).rgb() == psf::film::read_exr(b).rgb();
}

std::string info(const std::string& path) {
  return run("psf info " + path).out;
}

}  // namespace

TEST_CASE("psf-render killed over and over and resumed is as if it had never stopped") {
  const TempFolder folder;
  const std::string options = kScene + "--passes 12 --sampler halton --image ";
  REQUIRE(run("psf-render " + options + folder / "whole.exr -o " + folder / "whole.pvb").code == 0);
  const std::string command =
      "psf-render " + options + folder / "parts.exr -o " + folder / "parts.pvb --resume";
  int kills = 0;
  for (double wait = 0.03;; wait *= 1.15) {
    const Outcome outcome = run("timeout -s KILL " + std::to_string(wait) + " " + command);
    if (outcome.code == 0) break;
    REQUIRE(outcome.code == 137);
    ++kills;
  }
  CAPTURE(kills);
  CHECK(kills >= 1);
  CHECK(values_of(folder, "parts.pvb") == values_of(folder, "whole.pvb"));
  CHECK(same_picture(folder / "parts.exr", folder / "whole.exr"));
  CHECK(run("psf verify " + folder / "parts.pvb").code == 0);
  CHECK_FALSE(fs::exists(folder / "parts.pvb.partial"));
}

TEST_CASE("^C and a time limit stop at a commit, and --resume goes on") {
  const TempFolder folder;
  const std::string dump = folder / "a.pvb";
  const std::string command = "psf-render " + kScene + "-o " + dump + " --passes ";
  // A shell without job control lets its background jobs ignore ^C until they ask for it.
  const Outcome stopped = run("sh -c '" + command + "100000 & while ! test -e " + dump +
                              "; do sleep 0.05; done; kill -INT $!; wait $!'");
  CHECK(stopped.code == 130);
  CHECK(stopped.err.find("interrupted after pass ") != std::string::npos);
  CHECK(stopped.err.find("; --resume goes on") != std::string::npos);
  CHECK(run("psf verify " + dump).out.find(", not closed\n") != std::string::npos);
  CHECK(run(command + "100000 --time-limit 0.2 --resume").code == 0);
  CHECK(run("psf verify " + dump).out.find(", closed\n") != std::string::npos);
  const std::string more = "psf-render " + kScene + "-o " + folder / "b.pvb --passes ";
  REQUIRE(run(more + "2").code == 0);
  REQUIRE(run(more + "5 --resume").code == 0);
  REQUIRE(run("psf-render " + kScene + "-o " + folder / "c.pvb --passes 5").code == 0);
  CHECK(values_of(folder, "b.pvb") == values_of(folder, "c.pvb"));
}

TEST_CASE("psf filter --follow ends with the picture of the whole dump") {
  const TempFolder folder;
  const std::string dump = folder / "a.pvb", command = "psf-render " + kScene + "-o " + dump;
  // The follower starts before there is a first pass; the renderer is killed once on the way.
  const Outcome outcome = run("sh -c 'touch " + dump + ".partial; psf filter --follow " + dump +
                              " -o " + folder / "f.exr & timeout -s KILL 0.2 " + command +
                              " --passes 20; " + command + " --passes 20 --resume >&2; wait $!'");
  INFO(outcome.err);
  CHECK(outcome.code == 0);
  CHECK(outcome.out.find("81,920 in 20 passes") != std::string::npos);
  CHECK(outcome.err.find("20 passes: ") != std::string::npos);
  REQUIRE(run("psf filter " + dump + " -o " + folder / "w.exr --quiet").code == 0);
  CHECK(same_picture(folder / "f.exr", folder / "w.exr"));
}

TEST_CASE("psf recover says what it saved and what was lost, by its exit code too") {
  const TempFolder folder;
  const std::string dump = folder / "a.pvb", out = folder / "r.pvb";
  REQUIRE(run("psf-render " + kScene + "-o " + dump + " --passes 3").code == 0);
  const std::string whole = read_text(dump);
  const auto damage = [&](std::size_t place, const std::string& bytes) {
    std::string damaged = whole;
    damaged.replace(place, bytes.size(), bytes);
    std::ofstream(folder / "d.pvb", std::ios::binary) << damaged;
    fs::remove(out);
    return run("psf recover " + folder / "d.pvb " + out + " --json " + folder / "r.json");
  };
  const Outcome head = damage(0, std::string(4096, '\0'));
  CHECK(head.code == 0);
  CHECK(head.out.find("saved 12,288 records in 3 passes") != std::string::npos);
  CHECK(nlohmann::json::parse(read_text(folder / "r.json"))["head_restored"] == true);
  fs::rename(out, folder / "saved.pvb");
  CHECK(values_of(folder, "saved.pvb") == values_of(folder, "a.pvb"));
  CHECK(run("psf-render " + kScene + "-o " + folder / "saved.pvb --passes 4 --resume").code == 0);

  const Outcome column = damage(whole.size() / 2, "damage");
  CHECK(column.code == 1);
  CHECK(column.err.find("records are lost; ") != std::string::npos);
  CHECK(column.out.find("lost  byte ") != std::string::npos);
  CHECK(run("psf verify " + out).code == 0);
  CHECK(run("psf filter " + out + " -o " + folder / "r.exr --quiet").code == 0);
  const auto json = nlohmann::json::parse(read_text(folder / "r.json"));
  CHECK(json["records_lost"] == 4096);
  CHECK(json["records_saved"] == 8192);

  const Outcome nothing = damage(0, std::string(whole.size(), 'x'));
  CHECK(nothing.code == 3);
  CHECK_FALSE(fs::exists(out));
}

TEST_CASE("psf cat joins dumps rendered apart as one render would have filtered them") {
  const TempFolder folder;
  const auto render = [&](const std::string& name, const std::string& options) {
    REQUIRE(run("psf-render " + kScene + "-o " + folder / name + " " + options).code == 0);
  };
  render("a.pvb", "--passes 2 --seed 1");
  render("b.pvb", "--passes 3 --seed 2 --codec raw");
  const std::string inputs = folder / "a.pvb " + folder / "b.pvb ";
  REQUIRE(
      run("psf cat " + inputs + "-o " + folder / "ab.pvb --codec raw --json " + folder / "cat.json")
          .code == 0);
  CHECK(nlohmann::json::parse(read_text(folder / "cat.json"))["records"] == 5 * 4096);
  CHECK(info(folder / "ab.pvb").find("20,480 in 5 passes") != std::string::npos);
  // Its halves are what went in.
  REQUIRE(run("psf cat " + folder / "ab.pvb --passes 2: -o " + folder / "b2.pvb").code == 0);
  CHECK(values_of(folder, "b2.pvb") == values_of(folder, "b.pvb"));
  REQUIRE(run("psf cat " + folder / "b.pvb -o " +
              folder / "q.pvb --quantize normal,reflectance "
                       "--drop roughness,material --codec zstd")
              .code == 0);
  const std::string text = info(folder / "q.pvb");
  CHECK(text.find("normal         u16 x 2 oct") != std::string::npos);
  CHECK(text.find("reflectance    f16 x 3") != std::string::npos);
  CHECK(text.find("material       u32") == std::string::npos);
  REQUIRE(run("psf filter " + folder / "q.pvb -o " + folder / "q.exr --quiet").code == 0);
  REQUIRE(run("psf filter " + folder / "b.pvb -o " + folder / "b.exr --quiet").code == 0);
  CHECK(run("psf compare " + folder / "q.exr " + folder / "b.exr --max 1e-4").code == 0);
}
