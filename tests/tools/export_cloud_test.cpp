// The point clouds of psf export, read back by a parser of the tests' own.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <sstream>
#include <vector>

#include "catch.h"
#include "command.h"
#include "export_sample.h"

using namespace psf;
using tests::kRecords;
using tests::Outcome;
using tests::read_text;
using tests::run;
using tests::same_number;
using tests::Sample;
using tests::TempFolder;

namespace {

struct Ply {
  std::size_t points = 0;
  std::vector<std::string> names;
  std::map<std::string, std::vector<double>> values;
};

Ply parse_ply(const std::string& path) {
  const std::string text = read_text(path);
  const std::size_t end = text.find("end_header\n") + 11;
  std::istringstream lines(text.substr(0, end));
  std::string line;
  std::getline(lines, line);
  REQUIRE(line == "ply");
  std::getline(lines, line);
  REQUIRE(line == "format binary_little_endian 1.0");
  Ply ply;
  std::vector<std::string> types;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string first, second, third;
    words >> first >> second >> third;
    if (first == "element") {
      REQUIRE(second == "vertex");
      ply.points = std::stoul(third);
    } else if (first == "property") {
      types.push_back(second);
      ply.names.push_back(third);
    }
  }
  std::size_t at = end;
  const auto take = [&](auto value) {
    REQUIRE(at + sizeof value <= text.size());
    std::memcpy(&value, text.data() + at, sizeof value);
    at += sizeof value;
    return static_cast<double>(value);
  };
  for (std::size_t k = 0; k < ply.points; ++k) {
    for (std::size_t c = 0; c < types.size(); ++c) {
      ply.values[ply.names[c]].push_back(types[c] == "float"    ? take(float{})
                                         : types[c] == "double" ? take(double{})
                                                                : take(std::uint8_t{}));
    }
  }
  CHECK(at == text.size());
  return ply;
}

std::vector<std::size_t> points_of(const Sample& sample) {
  std::vector<std::size_t> points;
  const std::vector<float> position = sample.floats("position");
  const auto flags = sample.stored<std::uint8_t>("flags");
  for (std::size_t k = 0; k < kRecords; ++k) {
    const bool finite = std::isfinite(position[3 * k]) && std::isfinite(position[3 * k + 1]) &&
                        std::isfinite(position[3 * k + 2]);
    if (finite && flags[k] % 2 == 1) points.push_back(k);
  }
  return points;
}

// As the display does it, in double.
double shown(double linear) {
  if (!(linear > 0)) return 0;
  const double x = linear < 0.7 ? linear : 1 - 0.3 * std::exp((0.7 - linear) / 0.3);
  return 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055);
}

}  // namespace

TEST_CASE("a point cloud holds the vertices of the dump") {
  const TempFolder folder;
  const Sample sample(folder / "in.pvb");
  const Outcome outcome =
      run("psf export " + (folder / "in.pvb") + " -o " + (folder / "x.ply") +
          " --colour radiance --exposure 1 --channels time,material,contribution --json " +
          (folder / "x.json"));
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const Ply ply = parse_ply(folder / "x.ply");
  const std::vector<std::size_t> points = points_of(sample);
  REQUIRE(ply.points == points.size());
  CHECK(ply.names == std::vector<std::string>{"x", "y", "z", "nx", "ny", "nz", "red", "green",
                                              "blue", "scalar_time", "scalar_material",
                                              "scalar_contribution_r", "scalar_contribution_g",
                                              "scalar_contribution_b"});
  const auto position = sample.floats("position"), normal = sample.floats("normal");
  const auto c = sample.floats("contribution"), a = sample.floats("throughput");
  const auto u = sample.floats("unfiltered");
  const auto time = sample.stored<double>("time");
  const auto material = sample.stored<std::uint32_t>("material");
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::size_t i = points[k];
    for (std::size_t d = 0; d < 3; ++d) {
      const std::array<const char*, 3> x = {"x", "y", "z"}, n = {"nx", "ny", "nz"};
      const std::array<const char*, 3> rgb = {"red", "green", "blue"};
      const std::array<const char*, 3> s = {"scalar_contribution_r", "scalar_contribution_g",
                                            "scalar_contribution_b"};
      const std::size_t at = 3 * i + d;
      wrong += ply.values.at(x[d])[k] != static_cast<double>(position[at]);
      wrong += !same_number(static_cast<float>(ply.values.at(n[d])[k]), normal[at]);
      wrong += !same_number(static_cast<float>(ply.values.at(s[d])[k]), c[at]);
      const double radiance = static_cast<double>(u[at] + a[at] * c[at]);
      wrong += std::abs(ply.values.at(rgb[d])[k] - shown(2 * radiance)) > 0.51;
    }
    wrong += ply.values.at("scalar_material")[k] != material[i];
    const double t = ply.values.at("scalar_time")[k];
    wrong += !(t == time[i] || (std::isnan(t) && std::isnan(time[i])));
  }
  CHECK(wrong == 0);
  const std::string json = read_text(folder / "x.json");
  CHECK(json.find(fmt::format("\"written\": {}", points.size())) != std::string::npos);
}

TEST_CASE("every kind of channel has its colours") {
  const TempFolder folder;
  const Sample sample(folder / "in.pvb");
  const auto cloud = [&](const std::string& options) {
    const Outcome outcome = run("psf export " + (folder / "in.pvb") + " -o " + (folder / "x.ply") +
                                " --quiet " + options);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return parse_ply(folder / "x.ply");
  };
  const std::vector<std::size_t> points = points_of(sample);
  const auto rho = sample.floats("reflectance"), normal = sample.floats("normal");
  const Ply albedo = cloud("--colour reflectance"), direction = cloud("--colour normal");
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const float r = rho[3 * points[k]], n = normal[3 * points[k]];
    const double encoded =
        !(r > 0)
            ? 0
            : 255 * (r <= 0.0031308f ? 12.92 * r
                                     : 1.055 * std::pow(std::min(1.0, double{r}), 1 / 2.4) - 0.055);
    wrong += std::abs(albedo.values.at("red")[k] - encoded) > 0.51;
    const double unit = std::isnan(n) ? 0 : 127.5 * (double{n} + 1);
    wrong += std::abs(direction.values.at("red")[k] - unit) > 0.51;
  }
  CHECK(wrong == 0);
  const Ply grey = cloud("--colour distance");
  CHECK(grey.values.at("red") == grey.values.at("blue"));
  const Ply number = cloud("--colour flags");  // points have flags 1 or 3
  std::map<double, int> colours;
  for (const double red : number.values.at("red")) ++colours[red];
  CHECK(colours.size() == 2);
  CHECK(cloud("--colour none").values.count("red") == 0);
  // An exposure is for radiances.
  const Ply exposed = cloud("--colour reflectance --exposure auto");
  CHECK(exposed.values == albedo.values);
}

TEST_CASE("an automatic exposure shows the mean logarithm as middle grey") {
  const TempFolder folder;
  const Sample sample(folder / "in.pvb");
  REQUIRE(run("psf export " + (folder / "in.pvb") + " -o " + (folder / "x.ply") +
              " --colour unfiltered --exposure auto --json " + (folder / "x.json"))
              .code == 0);
  const auto u = sample.floats("unfiltered");
  double sum = 0, lit = 0;
  for (const std::size_t k : points_of(sample)) {
    const double y =
        0.2126 * double{u[3 * k]} + 0.7152 * double{u[3 * k + 1]} + 0.0722 * double{u[3 * k + 2]};
    if (!(y > 0) || !std::isfinite(y)) continue;
    sum += std::log(y);
    lit += 1;
  }
  const std::string json = read_text(folder / "x.json");
  const double exposure = std::atof(json.c_str() + json.find("\"exposure\": ") + 12);
  CHECK(exposure == Approx(std::log2(0.18 / std::exp(sum / lit))).margin(1e-4));
}

TEST_CASE("a table becomes a cloud without colours, unless a channel of it is named") {
  const TempFolder folder;
  const std::string dump = folder / "d.pvb", cloud = folder / "c.ply";
  REQUIRE(run("psf-render " PSF_SOURCE_DIR
              "/sample_data/cornell.json --quiet --size 8x8 --passes 1 "
              "--photons 50 -o " +
              dump)
              .code == 0);
  const std::string verb = "psf export " + dump + " --table photons -o " + cloud;
  for (const std::string options : {"", " --exposure auto"}) {
    const Outcome plain = run(verb + options);
    INFO(plain.err);
    REQUIRE(plain.code == 0);
    const Ply ply = parse_ply(cloud);
    CHECK(ply.points > 50);
    CHECK(ply.names == std::vector<std::string>{"x", "y", "z", "nx", "ny", "nz"});
  }
  REQUIRE(run(verb + " --colour power").code == 0);
  CHECK(parse_ply(cloud).names.size() == 9);
}
