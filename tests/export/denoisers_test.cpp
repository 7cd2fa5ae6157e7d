// Which paths, files and folders an export for a denoiser has, and what it says.
#include "export/denoisers.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "core/parallel.h"
#include "denoiser_oracle.h"

namespace fs = std::filesystem;
using namespace psf;
using namespace psf::tests;
using exports::Denoiser;

namespace {

std::set<std::string> files_in(const fs::path& folder) {
  std::set<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.insert(entry.path().lexically_relative(folder).string());
  }
  return files;
}

}  // namespace

TEST_CASE("A range of passes is exported as a dump of these passes alone would be") {
  const TempFolder folder;
  const DenoiserCase paths(1, 1);
  paths.write(folder / "in.pvb");
  const auto result = write(Denoiser::nfor, folder / "in.pvb", folder / "out", {1, 4});
  CHECK(result.paths.passes == 3);
  CHECK(result.paths.paths == 208);
  const Samples samples = paths.samples(26, 234);
  const film::Image image = film::read_exr((folder / "out") + "/colorB.exr");
  CHECK(wrong(image, "R", samples[0],
              [](const auto& pixel) { return mean_of(values_of(pixel, "color", 0), 1, 2); }) == 0);
  const auto passes = std::find(image.attributes.begin(), image.attributes.end(),
                                std::pair<std::string, std::string>("psf:passes", "1:4"));
  CHECK(passes != image.attributes.end());
  for (const run::PassSelection& none : {run::PassSelection{4, 7}, run::PassSelection{2, 2}}) {
    CHECK_THROWS_AS(write(Denoiser::nfor, folder / "in.pvb", folder / "x", none), Error);
  }
  CHECK(folder.file_count() == 2);
}

TEST_CASE("Every path of a dump of several blocks is counted once") {
  const TempFolder folder;
  DenoiserCase paths(1, 1);
  constexpr std::size_t kPaths = 300'000;  // more than 2^18
  paths.set = RecordSet(kPaths);
  for (std::size_t i = 0; i < kPaths; ++i) paths.set.pixel[i] = static_cast<std::uint32_t>(i % 20);
  paths.options.passes = {kPaths - 60'000, 60'000};
  paths.options.chunk_capacity = 1 << 16;
  paths.write(folder / "in.pvb");
  std::uint64_t last = 0;
  const auto result =
      exports::export_for(Denoiser::bcd, run::Dump(folder / "in.pvb"), {}, folder / "out", "1.2.3",
                          [&](std::uint64_t done, std::uint64_t total) {
                            CHECK(total == kPaths);
                            CHECK(done > last);
                            last = done;
                          });
  CHECK(result.paths.paths == kPaths);
  CHECK(last == kPaths);
  const film::Image histogram = film::read_exr((folder / "out") + "/color_hist.exr");
  const std::vector<float>& counts = *histogram.find("Bin_0060");
  CHECK(std::count(counts.begin(), counts.end(), 15'000.0f) == 20);
}

TEST_CASE("What is written for a denoiser has the same bytes for any number of threads") {
  const TempFolder folder;
  const DenoiserCase paths;
  paths.write(folder / "in.pvb");
  for (const Denoiser denoiser : {Denoiser::oidn, Denoiser::nfor, Denoiser::bcd}) {
    std::size_t files = 0;
    for (const std::size_t threads : {1u, 3u}) {
      const core::ThreadLimit limit(threads);
      const std::string name = "out" + std::to_string(static_cast<int>(denoiser));
      static_cast<void>(
          write(denoiser, folder / "in.pvb", folder / (name + "." + std::to_string(threads))));
      if (threads == 1) continue;
      for (const std::string& file : files_in(folder / (name + ".1"))) {
        const bool same = tests::read_text((folder / (name + ".1")) + "/" + file) ==
                          tests::read_text((folder / (name + ".3")) + "/" + file);
        CAPTURE(file);
        CHECK(same);
        ++files;
      }
    }
    CHECK(files >= 6);
  }
}

TEST_CASE("Features that a dump has no channel for are left out, and named") {
  const TempFolder folder;
  DenoiserCase paths(1, 1);
  paths.options.without_channels = {"reflectance", "normal"};
  paths.write(folder / "in.pvb");
  const auto oidn = write(Denoiser::oidn, folder / "in.pvb", folder / "oidn");
  CHECK(files_in(folder / "oidn") == std::set<std::string>{"color.pfm"});
  REQUIRE(oidn.notes.size() == 2);
  CHECK(oidn.notes[0].find("has no channel reflectance, so albedo is left out") !=
        std::string::npos);
  CHECK(oidn.notes[1].find("has no channel normal, so normal is left out") != std::string::npos);
  const auto nfor = write(Denoiser::nfor, folder / "in.pvb", folder / "nfor");
  CHECK(nfor.notes.size() == 2);
  CHECK(files_in(folder / "nfor").size() == 9);
  std::ifstream in((folder / "nfor") + "/scene.json");
  const auto scene = nlohmann::json::parse(in);
  const auto& buffers = scene["renderer"]["output_buffers"];
  REQUIRE(buffers.size() == 2);
  for (const auto& buffer : buffers) {
    const std::string type = buffer["type"];
    CHECK((type == "color" || type == "depth"));
    CHECK(buffer["hdr_output_file"] == type + ".exr");
    CHECK(buffer["sample_variance"] == true);
    CHECK(buffer["two_buffer_variance"] == true);
  }
  CHECK(write(Denoiser::bcd, folder / "in.pvb", folder / "bcd").notes.empty());
}

TEST_CASE("Pixels without samples or with one are counted; OIDN gets the colour around them") {
  const TempFolder folder;
  DenoiserCase paths(1, 1);
  std::size_t ones = 0;
  for (std::size_t i = 0; i < paths.set.size(); ++i) {
    std::uint32_t& pixel = paths.set.pixel[i];
    if (pixel == 0) pixel = 1;  // pixel 0 has no path, pixel 2 has one
    if (pixel == 2 && ones++ > 0) pixel = 3;
  }
  paths.write(folder / "in.pvb");
  const auto oidn = write(Denoiser::oidn, folder / "in.pvb", folder / "oidn");
  CHECK(oidn.without_path == 1);
  CHECK(oidn.with_one_path == 1);
  REQUIRE(oidn.notes.size() == 1);
  CHECK(oidn.notes[0].find("no path in the picture of 1 pixel") != std::string::npos);
  const std::vector<float> color = read_pfm((folder / "oidn") + "/color.pfm", 5, 4);
  CHECK(color[1] > 0);
  const auto nfor = write(Denoiser::nfor, folder / "in.pvb", folder / "nfor");
  CHECK(nfor.notes.size() == 2);
  for (const std::string name : {"color", "colorA", "colorB", "colorVariance"}) {
    CAPTURE(name);
    const film::Image image = film::read_exr((folder / "nfor") + "/" + name + ".exr");
    CHECK((*image.find("G"))[0] == 0);
    CHECK(((*image.find("G"))[2] == 0) == (name == "colorB" || name == "colorVariance"));
  }
  static_cast<void>(write(Denoiser::bcd, folder / "in.pvb", folder / "bcd"));
  for (const std::string name : {"color", "color_cov", "color_hist"}) {
    for (const film::Layer& layer : film::read_exr((folder / "bcd") + "/" + name + ".exr").layers) {
      CHECK(layer.values[0] == 0);
      CHECK((name != "color_cov" || layer.values[2] == 0));
    }
  }
}

TEST_CASE("A folder with something in it stays as it is") {
  const TempFolder folder;
  const DenoiserCase paths;
  paths.write(folder / "in.pvb");
  fs::create_directory(folder / "full");
  std::ofstream(folder / "full/mine") << "mine";
  std::ofstream(folder / "file") << "mine";
  fs::create_directory(folder / "empty");
  const std::size_t files = folder.file_count();
  for (const std::string name : {"full", "file"}) {
    CHECK_THROWS_AS(write(Denoiser::bcd, folder / "in.pvb", folder / name), Error);
    CHECK(folder.file_count() == files);
  }
  CHECK(files_in(folder / "full") == std::set<std::string>{"mine"});
  static_cast<void>(write(Denoiser::bcd, folder / "in.pvb", folder / "empty"));
  CHECK(files_in(folder / "empty").size() == 6);
}
