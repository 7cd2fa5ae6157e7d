// A dump with nothing but the five required channels, as a renderer of someone else's writes it:
// every verb takes it, and says once what it does without.
#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "catch.h"
#include "command.h"
#include "film/image.h"
#include "formats/write/writer.h"

using psf::tests::Outcome;
using psf::tests::read_text;
using psf::tests::run;
using psf::tests::TempFolder;

namespace {

namespace formats = psf::formats;

constexpr std::uint32_t kSide = 24, kPasses = 16;

// A floor seen from above, with noise; `more` channels all 0.
void write(const std::string& path, std::uint32_t seed, const std::vector<std::string>& more = {}) {
  std::mt19937 random(seed);
  std::exponential_distribution<float> noise;
  using formats::Type;
  formats::Head head;
  head.metadata =
      R"({"cameras": [{"width": 24, "height": 24, "angle_per_pixel": 0.01}], "seed": )" +
      std::to_string(seed) + "}";
  head.channels = {{"position", Type::f32, 3, formats::Encoding::plain},
                   {"throughput", Type::f32, 3, formats::Encoding::plain},
                   {"contribution", Type::f32, 3, formats::Encoding::plain},
                   {"distance", Type::f32, 1, formats::Encoding::plain},
                   {"pixel", Type::u32, 1, formats::Encoding::plain}};
  constexpr std::size_t kPixels = kSide * kSide;
  std::vector<float> position(3 * kPixels), ones(3 * kPixels, 1.0f), c(3 * kPixels),
      distance(kPixels, 1.0f), zeros(3 * kPixels);
  std::vector<std::uint32_t> pixel(kPixels);
  for (const std::string& name : more) {
    const bool word = name == "visibility" || name == "material";
    head.channels.push_back({name, word ? Type::u32 : Type::f32,
                             static_cast<std::uint8_t>(word ? 1 : 3), formats::Encoding::plain});
  }
  formats::Writer writer(path, head, {});
  for (std::uint32_t pass = 0; pass < kPasses; ++pass) {
    for (std::uint32_t k = 0; k < kPixels; ++k) {
      pixel[k] = k;
      position[3 * k] = 0.01f * static_cast<float>(k % kSide);
      position[3 * k + 2] = 0.01f * static_cast<float>(k / kSide);
      for (std::size_t channel = 0; channel < 3; ++channel) c[3 * k + channel] = noise(random);
    }
    std::vector<const void*> columns = {position.data(), ones.data(), c.data(), distance.data(),
                                        pixel.data()};
    for (std::size_t k = 0; k < more.size(); ++k) columns.push_back(zeros.data());
    writer.append(kPixels, columns);
    writer.commit();
  }
  writer.close();
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
    ++found;
  return found;
}

// Verbs that filter, each with all it needs; "<dump>", "<out>" and "<reference>" stand for files.
std::string command(std::string verb, const TempFolder& folder, const std::string& dump) {
  const auto put = [&verb](const std::string& name, const std::string& value) {
    for (std::size_t at = verb.find(name); at != std::string::npos; at = verb.find(name))
      verb.replace(at, name.size(), value);
  };
  put("<dump>", dump);
  put("<out>", folder / "out");
  put("<reference>", folder / "reference.exr");
  return "psf " + verb;
}
const std::array<const char*, 6> kVerbs = {
    "filter <dump> -o <out>.exr",
    "tune <dump> --r0 2px,4px --json <out>.json",
    "sweep <dump> --reference <reference> --r0 2px,4px -o <out>.s",
    "converge <dump> --reference <reference> --r0 2px -o <out>.c --no-times",
    "ablate <dump> --reference <reference> -o <out>.png",
    "explain <dump> --pixel 3,4"};

void write_reference(const TempFolder& folder) {
  psf::film::Image image;
  image.width = image.height = kSide;
  image.add("", "RGB", std::vector<float>(3 * kSide * kSide, 1.0f));
  psf::film::write_image(folder / "reference.exr", image);
}

}  // namespace

TEST_CASE("Terms that are on by default and whose channel is missing are off, with one note") {
  for (const char* verb : kVerbs) {
    const TempFolder folder;
    write(folder / "a.pvb", 1);
    write_reference(folder);
    const std::string line = command(verb, folder, folder / "a.pvb");
    INFO(line);
    const Outcome outcome = run(line);
    INFO(outcome.err);
    CHECK(outcome.code == 0);
    CHECK(count(outcome.err, "note:") == 1);
    CHECK(outcome.err.find(
              "note: " + folder / "a.pvb" +
              ": has no channel normal, reflectance, visibility, direction, roughness, so "
              "--normal, --reflectance, --visibility, --gloss are off\n") != std::string::npos);
  }
}

TEST_CASE("What cannot be done is one line: no note comes before it") {
  const TempFolder folder;
  write(folder / "a.pvb", 1);
  write_reference(folder);
  for (const std::string verb :
       {"filter <dump> -o <out>.exr --snapshots 99", "filter <dump> -o <out>.exr --passes 0:99",
        "filter <dump> -o <out>.exr --camera other", "tune <dump> --passes 0:99",
        "sweep <dump> --reference <reference> -o <out>.s --passes 0:99",
        "converge <dump> --reference <reference> -o <out>.c --passes 0:99",
        "ablate <dump> -o <out>.png --passes 0:99", "explain <dump> --pixel 99,4",
        "explain <dump> --pixel 3,4 --passes 0:99"}) {
    const Outcome outcome = run(command(verb, folder, folder / "a.pvb"));
    INFO(verb << ": " << outcome.err);
    CHECK(outcome.code == 2);
    CHECK(count(outcome.err, "\n") == 1);
  }
}

TEST_CASE("What is there stays on, and a note names the rest alone") {
  const TempFolder folder;
  write(folder / "a.pvb", 1, {"normal", "visibility"});
  const Outcome outcome = run("psf filter " + folder / "a.pvb" + " -o " + folder / "out.exr");
  CHECK(outcome.code == 0);
  CHECK(outcome.err.find(
            "has no channel reflectance, direction, roughness, so --reflectance, --gloss "
            "are off\n") != std::string::npos);
  CHECK(outcome.out.find("weights    normal 0.95, visibility\n") != std::string::npos);
  CHECK(run("psf filter " + folder / "a.pvb" + " --quiet -o " + folder / "out.exr").err.empty());
}

TEST_CASE("A term that was asked for is an error that names its channel") {
  for (const char* verb : kVerbs) {
    for (const char* term :
         {"--normal=0.95", "--reflectance=0.05", "--visibility=on", "--plane=0.5", "--material=on",
          "--no-weights --direction=0.9", "--gloss=0.8"}) {
      const TempFolder folder;
      write(folder / "a.pvb", 1);
      write_reference(folder);
      const bool one =
          std::string(verb).starts_with("filter") || std::string(verb).starts_with("explain");
      std::string option = term;
      if (one && option == "--material=on") option = "--material";
      if (one && option == "--visibility=on") option = "--visibility";
      const std::string line = command(verb, folder, folder / "a.pvb") + " " + option;
      INFO(line);
      const Outcome outcome = run(line);
      INFO(outcome.err);
      CHECK(outcome.code == 3);
      CHECK(outcome.err.find("has no channel ") != std::string::npos);
      const std::string name = std::string(term).substr(std::string(term).rfind("--"));
      CHECK(outcome.err.find("which " + name.substr(0, name.find('=')) + " needs") !=
            std::string::npos);
    }
  }
}

TEST_CASE("What psf tune chose counts as asked for") {
  const TempFolder folder;
  write(folder / "all.pvb", 1, {"normal", "reflectance", "visibility"});
  write(folder / "few.pvb", 1);
  for (const char* name : {"all", "few"}) {
    const std::string dump = folder / (std::string(name) + ".pvb");
    REQUIRE(run("psf tune " + dump + " --quiet --r0 2px,4px --json " + folder / name).code == 0);
  }
  const auto filter = [&](const char* tuned) {
    return run("psf filter " + folder / "few.pvb" + " --tuned " + folder / tuned + " -o " +
               folder / "out.exr");
  };
  CHECK(filter("all").code == 3);
  CHECK(filter("all").err.find("has no channel normal, which --normal needs") != std::string::npos);
  CHECK(filter("few").code == 0);
  CHECK(filter("few").err.find("note:") == std::string::npos);
}

TEST_CASE("The other verbs take it, and u has no share of the noise where there is none") {
  const TempFolder folder;
  write(folder / "a.pvb", 1);
  for (const std::string verb : {"info <dump> --stats --json <out>", "verify <dump>",
                                 "cat <dump> -o <out>.pvb", "export <dump> -o <out>.ply",
                                 "export <dump> -o <out>.csv", "export <dump> -o <out>folder"}) {
    const std::string line = command(verb, folder, folder / "a.pvb");
    const Outcome outcome = run(line);
    INFO(line << ": " << outcome.err);
    CHECK(outcome.code == 0);
  }
  const auto info = nlohmann::json::parse(read_text(folder / "out"));
  CHECK(info.at("noise").at(0).at("unfiltered_share") == 0);
  CHECK(info.at("noise").at(0).at("pixels") == kSide * kSide);
  REQUIRE(run("psf filter " + folder / "a.pvb" + " --quiet -o " + folder / "f.exr --json " +
              folder / "f.json")
              .code == 0);
  const auto filtered = nlohmann::json::parse(read_text(folder / "f.json"));
  CHECK(filtered.at("noise") == info.at("noise"));
}
