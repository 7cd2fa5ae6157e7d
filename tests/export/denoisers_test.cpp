// What denoisers get is what a naive loop over the paths finds, and the picture without filter.
#include "export/denoisers.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "../catch.h"
#include "../read_text.h"
#include "core/error.h"
#include "core/parallel.h"
#include "denoiser_case.h"
#include "export/denoiser_input.h"
#include "film/image.h"
#include "run/filter_dump.h"

namespace fs = std::filesystem;
using namespace psf;
using exports::Denoiser;
using tests::DenoiserCase;
using tests::RecordSet;
using tests::Sample;
using tests::Samples;
using tests::TempFolder;

namespace {

const std::array<std::string, 2> kFolders = {"camera_0/", "camera_1/"};

exports::DenoiserResult write(Denoiser denoiser, const std::string& dump, const std::string& folder,
                              const run::PassSelection& passes = {}) {
  return exports::export_for(denoiser, run::Dump(dump), passes, folder, "1.2.3");
}

// (height, width, 3), row 0 at the top.
std::vector<float> read_pfm(const std::string& path, std::size_t width, std::size_t height) {
  const std::string text = tests::read_text(path);
  const std::string header =
      "PF\n" + std::to_string(width) + " " + std::to_string(height) + "\n-1.0\n";
  REQUIRE(text.substr(0, header.size()) == header);
  REQUIRE(text.size() == header.size() + width * height * 12);
  std::vector<float> values(3 * width * height);
  for (std::size_t y = 0; y < height; ++y) {
    std::memcpy(&values[3 * width * y], &text[header.size() + 12 * width * (height - 1 - y)],
                12 * width);
  }
  return values;
}

// The values of one component of the samples that count.
using Values = std::vector<double>;
Values values_of(const std::vector<Sample>& samples, const std::string& what, std::size_t c) {
  Values values;
  for (const Sample& s : samples) {
    if (what == "color" && !s.in_picture) continue;
    values.push_back(double{what == "color"    ? s.color[c]
                            : what == "albedo" ? s.albedo[c]
                            : what == "normal" ? s.normal[c]
                                               : s.depth});
  }
  return values;
}

double mean_of(const Values& values, std::size_t first = 0, std::size_t step = 1) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t k = first; k < values.size(); k += step, ++n) sum += values[k];
  return n > 0 ? sum / static_cast<double>(n) : 0;
}

// Of a and b; that of the samples, over n - 1.
double covariance(const Values& a, const Values& b) {
  if (a.size() < 2) return 0;
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - mean_of(a)) * (b[k] - mean_of(b));
  return sum / static_cast<double>(a.size() - 1);
}

bool near(float found, double expected) {
  return std::abs(double{found} - expected) <= 1e-6 * std::abs(expected) + 1e-12;
}

// How many pixels of a channel are not what `expected` of the pixel's samples is; counts pixels.
std::size_t wrong(const film::Image& image, const std::string& channel,
                  const std::vector<std::vector<Sample>>& pixels,
                  const std::function<double(const std::vector<Sample>&)>& expected) {
  const std::vector<float>* plane = image.find(channel);
  REQUIRE(plane != nullptr);
  REQUIRE(plane->size() == pixels.size());
  std::size_t count = 0;
  for (std::size_t pixel = 0; pixel < pixels.size(); ++pixel) {
    count += near((*plane)[pixel], expected(pixels[pixel])) ? 0u : 1u;
  }
  return count;
}

// Shares of a sample in BCD's bins: bin k is full where s = k / 18, the last where s = 2.
std::vector<double> shares_of(double value) {
  const double s = std::pow(std::max(value, 0.0), 1 / 2.2) / 2.5;
  std::vector<double> full, shares(20);
  for (int k = 0; k < 19; ++k) full.push_back(k / 18.0);
  full.push_back(2);
  if (s >= 2) shares[19] = 1;
  for (std::size_t k = 0; k + 1 < full.size(); ++k) {
    if (s < full[k] || s >= full[k + 1]) continue;
    shares[k + 1] = (s - full[k]) / (full[k + 1] - full[k]);
    shares[k] = 1 - shares[k + 1];
  }
  return shares;
}

std::string bin_name(std::size_t k) {
  const std::string number = std::to_string(k);
  return "Bin_" + std::string(4 - number.size(), '0') + number;
}

std::set<std::string> files_in(const fs::path& folder) {
  std::set<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.insert(entry.path().lexically_relative(folder).string());
  }
  return files;
}

}  // namespace

TEST_CASE("NFOR gets means, half buffers and variances as a naive loop finds them") {
  for (const std::uint32_t shade_rate : {1u, 2u}) {
    CAPTURE(shade_rate);
    const TempFolder folder;
    DenoiserCase paths(shade_rate);
    const auto [left_out, overflows] = paths.spoil();
    paths.write(folder / "in.pvb");
    const auto result = write(Denoiser::nfor, folder / "in.pvb", folder / "out");
    CHECK(result.paths.left_out == left_out);
    CHECK(result.paths.overflows == overflows);
    CHECK(result.paths.passes == 6);
    CHECK(result.paths.paths == paths.set.size());
    CHECK(result.files.size() == 2 * 17);
    const Samples samples = paths.samples(0, paths.set.size());
    for (std::size_t camera = 0; camera < 2; ++camera) {
      const std::string in = (folder / "out") + "/" + kFolders[camera];
      for (const std::string what : {"color", "albedo", "normal", "depth"}) {
        const std::string channels = what == "depth" ? "Y" : "RGB";
        for (std::size_t c = 0; c < channels.size(); ++c) {
          CAPTURE(camera, what, c);
          const auto check = [&](const std::string& part, const auto& expected) {
            CAPTURE(part);
            const film::Image image = film::read_exr(in + what + part + ".exr");
            CHECK(image.layers.size() == channels.size());
            CHECK(wrong(image, std::string(1, channels[c]), samples[camera],
                        [&](const auto& pixel) { return expected(values_of(pixel, what, c)); }) ==
                  0);
          };
          check("", [](const Values& values) { return mean_of(values); });
          check("A", [](const Values& values) { return mean_of(values, 0, 2); });
          check("B", [](const Values& values) { return mean_of(values, 1, 2); });
          check("Variance", [](const Values& values) {
            return covariance(values, values) / static_cast<double>(values.size());
          });
        }
      }
    }
  }
}

TEST_CASE("BCD gets histograms and covariances as a naive loop finds them") {
  const TempFolder folder;
  DenoiserCase paths;
  paths.spoil();
  paths.write(folder / "in.pvb");
  CHECK(write(Denoiser::bcd, folder / "in.pvb", folder / "out").files.size() == 6);
  const Samples samples = paths.samples(0, paths.set.size());
  constexpr std::size_t kPairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
  for (std::size_t camera = 0; camera < 2; ++camera) {
    CAPTURE(camera);
    const std::string in = (folder / "out") + "/" + kFolders[camera];
    const film::Image color = film::read_exr(in + "color.exr");
    const film::Image covariances = film::read_exr(in + "color_cov.exr");
    const film::Image histogram = film::read_exr(in + "color_hist.exr");
    CHECK(color.layers.size() == 3);
    CHECK(covariances.layers.size() == 6);
    CHECK(histogram.layers.size() == 61);
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK(wrong(color, std::string(1, "RGB"[c]), samples[camera],
                  [&](const auto& pixel) { return mean_of(values_of(pixel, "color", c)); }) == 0);
      for (std::size_t k = 0; k < 20; ++k) {
        CAPTURE(c, k);
        CHECK(wrong(histogram, bin_name(20 * c + k), samples[camera], [&](const auto& pixel) {
                double sum = 0;
                for (const double value : values_of(pixel, "color", c)) sum += shares_of(value)[k];
                return sum;
              }) == 0);
      }
    }
    for (std::size_t k = 0; k < 6; ++k) {
      CAPTURE(k);
      CHECK(wrong(covariances, bin_name(k), samples[camera], [&](const auto& pixel) {
              return covariance(values_of(pixel, "color", kPairs[k][0]),
                                values_of(pixel, "color", kPairs[k][1]));
            }) == 0);
    }
    // All bins of a channel hold all samples.
    const std::vector<float>& count = *histogram.find("Bin_0060");
    for (std::size_t pixel = 0; pixel < count.size(); ++pixel) {
      CHECK(count[pixel] == static_cast<float>(samples[camera][pixel].size()));
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (std::size_t k = 0; k < 20; ++k)
          sum += double{(*histogram.find(bin_name(20 * c + k)))[pixel]};
        CHECK(sum == Approx(double{count[pixel]}));
      }
    }
  }
}

TEST_CASE("Black is in BCD's first bin, 2.5^2.2 in the last but one, 5^2.2 and more in the last") {
  CHECK(exports::bcd_bin_place(0) == 0);
  CHECK(exports::bcd_bin_place(-3) == 0);
  CHECK(exports::bcd_bin_place(std::pow(2.5, 2.2)) == Approx(18));
  CHECK(exports::bcd_bin_place(std::pow(2.5 * 3.25 / 18, 2.2)) == Approx(3.25));
  CHECK(exports::bcd_bin_place(std::pow(5, 2.2)) == Approx(19));
  CHECK(exports::bcd_bin_place(1e30) == 19);
}

TEST_CASE("Colours and features are those of the filter's pictures, to the last bit") {
  for (const std::uint32_t shade_rate : {1u, 2u}) {
    const TempFolder folder;
    DenoiserCase paths(shade_rate);
    paths.spoil();
    paths.options.passes = {293};
    paths.write(folder / "in.pvb");
    static_cast<void>(write(Denoiser::oidn, folder / "in.pvb", folder / "out"));
    const run::Dump dump(folder / "in.pvb");
    run::FilterRequest request;
    request.parameters.block.kind = filter::BlockSize::Kind::all;
    const run::FilterResult filtered = run::filter_dump(dump, request);
    for (std::size_t camera = 0; camera < 2; ++camera) {
      const film::Image image = filtered.pictures[camera].image();
      const std::string in = (folder / "out") + "/" + kFolders[camera];
      const auto same = [&](const std::string& file, const std::string& prefix,
                            const std::string& suffixes) {
        const std::vector<float> values = read_pfm(in + file, image.width, image.height);
        std::size_t differ = 0;
        for (std::size_t c = 0; c < 3; ++c) {
          const std::vector<float>& plane = *image.find(prefix + suffixes[c]);
          for (std::size_t pixel = 0; pixel < plane.size(); ++pixel) {
            differ += values[3 * pixel + c] == plane[pixel] ? 0u : 1u;
          }
        }
        CAPTURE(shade_rate, camera, file);
        CHECK(differ == 0);
      };
      same("color.pfm", "unfiltered-input.", "RGB");
      same("albedo.pfm", "albedo.", "RGB");
      same("normal.pfm", "normal.", "XYZ");
    }
  }
}

TEST_CASE("Half buffers add up to the mean, and equal samples have no variance") {
  const TempFolder folder;
  DenoiserCase paths(1, 1);
  for (Rgb& rho : paths.set.reflectance) rho = Rgb(0.1f, 0.7f, 0.3f);
  for (std::uint8_t& flags : paths.set.flags) flags = filter::kHasVertex | filter::kShaded;
  paths.write(folder / "in.pvb");
  static_cast<void>(write(Denoiser::nfor, folder / "in.pvb", folder / "out"));
  const auto read = [&](const std::string& name) {
    return film::read_exr((folder / "out") + "/" + name + ".exr");
  };
  const film::Image whole = read("color"), a = read("colorA"), b = read("colorB");
  const Samples samples = paths.samples(0, paths.set.size());
  for (std::size_t pixel = 0; pixel < 20; ++pixel) {
    const double n = static_cast<double>(samples[0][pixel].size());
    REQUIRE(n > 1);
    const double sum = std::ceil(n / 2) * double{(*a.find("G"))[pixel]} +
                       std::floor(n / 2) * double{(*b.find("G"))[pixel]};
    CHECK(sum / n == Approx(double{(*whole.find("G"))[pixel]}).epsilon(1e-6));
    CHECK((*a.find("G"))[pixel] != (*b.find("G"))[pixel]);
  }
  const film::Image variance = read("albedoVariance");
  for (const film::Layer& layer : variance.layers) {
    CHECK(std::count(layer.values.begin(), layer.values.end(), 0.0f) == 20);
  }
}

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
