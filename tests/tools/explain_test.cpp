// psf explain as a program: its figures are those of psf filter, its point cloud is what it says,
// and mistakes are told.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "catch.h"
#include "command.h"
#include "film/image.h"

using psf::tests::Outcome;
using psf::tests::read_text;
using psf::tests::run;
using psf::tests::TempFolder;

namespace {

class Explained {
 public:
  Explained() { render("a.pvb", "cornell.json --size 32x32 --passes 4"); }
  void render(const std::string& name, const std::string& options) const {
    const Outcome outcome = run("psf-render " PSF_SOURCE_DIR "/sample_data/" + options +
                                " --quiet -o " + folder_ / name);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
  }
  [[nodiscard]] Outcome explain(const std::string& options,
                                const std::string& name = "a.pvb") const {
    return run("psf explain " + folder_ / name + " --quiet " + options);
  }
  [[nodiscard]] nlohmann::json figures(const std::string& options) const {
    const Outcome outcome = explain(options + " --json " + folder_ / "out.json");
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return nlohmann::json::parse(read_text(folder_ / "out.json"));
  }
  [[nodiscard]] psf::film::Image filter(const std::string& options) const {
    REQUIRE(run("psf filter " + folder_ / "a.pvb" + " --quiet -o " + folder_ / "out.exr " + options)
                .code == 0);
    return psf::film::read_exr(folder_ / "out.exr");
  }
  [[nodiscard]] std::string operator/(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] std::size_t file_count() const { return folder_.file_count(); }

 private:
  TempFolder folder_;
};

bool is_close(double a, double b) {
  return std::abs(a - b) <= 1e-6 * (1 + std::abs(b));
}

// As the header of explain/ply.h has it.
struct Point {
  std::array<float, 3> position{}, normal{};
  std::array<unsigned char, 3> colour{};
  float kind = 0, share = 0, excess = 0, paths = 0, distance = 0, refused_by = 0, x = 0, y = 0;
  double record = 0;
  float kept = 1, given = 0;  // where fireflies are not kept
};

std::vector<Point> read_points(const std::string& path, bool fireflies = false) {
  const std::string text = read_text(path);
  const std::string start = "ply\nformat binary_little_endian 1.0\n";
  REQUIRE(text.compare(0, start.size(), start) == 0);
  const std::string element = "element vertex ", end = "end_header\n";
  const std::size_t count = std::stoul(text.substr(text.find(element) + element.size()));
  std::size_t at = text.find(end) + end.size();
  const std::size_t row = 6 * 4 + 3 + 8 * 4 + 8 + (fireflies ? 2 * 4 : 0);
  REQUIRE(text.size() == at + count * row);
  std::vector<Point> points(count);
  const auto take = [&](auto& value) {
    std::memcpy(&value, text.data() + at, sizeof value);
    at += sizeof value;
  };
  for (Point& point : points) {
    take(point.position);
    take(point.normal);
    take(point.colour);
    for (float* value : {&point.kind, &point.share, &point.excess, &point.paths, &point.distance,
                         &point.refused_by, &point.x, &point.y}) {
      take(*value);
    }
    take(point.record);
    if (!fireflies) continue;
    take(point.kept);
    take(point.given);
  }
  return points;
}

}  // namespace

TEST_CASE("psf explain gives the pixel that psf filter gives, as the sum of its shares") {
  const Explained work;
  for (const std::string options :
       {"", "--no-weights --block all", "--demodulate --r0 0.1", "--sources 1/3 --passes 1:4",
        "--fit linear --search brute", "--fireflies spread", "--fireflies clamp:2 --demodulate",
        "--fit linear --fireflies spread --estimator adaptive --r0 0.1 --search brute"}) {
    const psf::film::Image image = work.filter(options);
    const std::vector<psf::Rgb> filtered = image.rgb(), own = image.rgb("unfiltered-input.");
    for (const auto& [x, y] : {std::pair{3, 9}, {20, 29}, {16, 16}}) {
      const auto pixel = static_cast<std::size_t>(32 * y + x);
      const nlohmann::json figures =
          work.figures(options + " --pixel " + std::to_string(x) + "," + std::to_string(y));
      INFO(options << " " << x << "," << y);
      double sum[3] = {0, 0, 0}, neighbors = 0;
      for (const auto& path : figures.at("paths")) {
        const auto& of = path.at("neighbors");
        for (std::size_t k = 0; k < of.at("record").size(); ++k) {
          for (std::size_t c = 0; c < 3; ++c) sum[c] += of.at("share")[k][c].get<double>();
          neighbors += of.at("averaged")[k] && of.at("in_ball")[k] ? 1 : 0;
        }
        for (std::size_t c = 0; c < 3; ++c) {
          sum[c] += path.at("unfiltered")[c].get<double>() /
                    static_cast<double>(figures.at("paths").size());
        }
      }
      neighbors /= static_cast<double>(figures.at("paths").size());
      for (std::size_t c = 0; c < 3; ++c) {
        const auto value = double{filtered[pixel][static_cast<int>(c)]};
        CHECK(is_close(sum[c], value));
        CHECK(is_close(figures.at("value").at("filtered")[c].get<double>(), value));
        const auto& own_value = figures.at("value").at("own");
        if (own_value.is_null()) continue;
        CHECK(is_close(own_value[c].get<double>(), double{own[pixel][static_cast<int>(c)]}));
      }
      CHECK(is_close(neighbors, double{(*image.find("neighbors.Y"))[pixel]}));
    }
  }
}

TEST_CASE("Weights, what is kept and what is given add up to c_bar in the figures, too") {
  const Explained work;
  std::size_t given = 0, kept = 0, fireflies = 0;
  double least = 1;
  for (const char* pixel : {"20,29", "16,16", "7,27", "20,3"}) {
    const nlohmann::json figures = work.figures(
        "--fit linear --fireflies spread --block all --search brute --pixel " + std::string(pixel));
    fireflies += figures.at("fireflies").size();
    double of_pixel = 0;
    for (const auto& path : figures.at("paths")) {
      const auto& of = path.at("neighbors");
      REQUIRE(!path.at("fit").is_null());
      double sum = 0, gifts = 0, mean = 0;
      for (std::size_t k = 0; k < of.at("record").size(); ++k) {
        const auto c = of.at("contribution")[k][0].get<double>();
        const auto part = of.at("kept")[k].get<double>(),
                   weight = of.at("weight")[k][0].get<double>();
        sum += weight * part * c;
        gifts += of.at("given")[k].get<double>() * c;
        if (of.at("averaged")[k]) mean += part * c / path.at("averaged").get<double>();
        given += of.at("given")[k] > 0 ? 1u : 0u;
        kept += part < 1 ? 1u : 0u;
        least = std::min(least, weight * path.at("averaged").get<double>());
      }
      CHECK(is_close(sum + gifts, path.at("c_bar")[0].get<double>()));
      CHECK(is_close(gifts, path.at("given")[0].get<double>()));
      CHECK(is_close(mean, path.at("fit").at("mean")[0].get<double>()));
      of_pixel += gifts * path.at("throughput")[0].get<double>() / 4;
    }
    CHECK(is_close(of_pixel, figures.at("value").at("given")[0].get<double>()));
  }
  CHECK(fireflies > 0);
  CHECK(given > 0);
  CHECK(kept > 0);
  CHECK(least < 0.9);
}

TEST_CASE("The text tells of fits and fireflies where there are any, and nowhere else") {
  const Explained work;
  const std::string mean = work.explain("--pixel 16,16").out;
  const Outcome both =
      work.explain("--pixel 16,16 --block all --fit linear --fireflies spread --all");
  const Outcome dimmed = work.explain("--pixel 16,16 --block all --fireflies clamp:1 --all");
  CHECK(both.code == 0);
  for (const char* words : {"\nfit  ", "\nfireflies ", "if mean", "plane   weight", "keeps",
                            "given", "gives here", "    ridge "}) {
    INFO(words);
    CHECK(both.out.find(words) != std::string::npos);
    CHECK(mean.find(words) == std::string::npos);
  }
  CHECK(dimmed.out.find("keeps") != std::string::npos);
  CHECK(dimmed.out.find("gives here") == std::string::npos);
  CHECK(dimmed.out.find("if mean") == std::string::npos);
  std::size_t widest = 0, begin = 0;
  for (std::size_t end = 0; (end = both.out.find('\n', begin)) != std::string::npos;
       begin = end + 1) {
    widest = std::max(widest, end - begin);
  }
  CHECK(widest <= 120);
}

TEST_CASE("psf explain writes the same bytes for any number of threads") {
  const Explained work;
  std::vector<std::string> json, ply, text;
  for (const char* threads : {"1", "2"}) {
    const Outcome outcome = work.explain("--pixel 20,29 --threads " + std::string(threads) +
                                         " --json " + work / "t.json" + " --ply " + work / "t.ply");
    REQUIRE(outcome.code == 0);
    text.push_back(outcome.out);
    json.push_back(read_text(work / "t.json"));
    ply.push_back(read_text(work / "t.ply"));
  }
  CHECK(text[0] == text[1]);
  CHECK(json[0] == json[1]);
  CHECK(ply[0] == ply[1]);
}

TEST_CASE("The point cloud holds every vertex once, its shares are those of the figures") {
  const Explained work;
  const std::string options = "--pixel 7,27 --r0 6px --ply " + work / "a.ply";
  const nlohmann::json figures = work.figures(options);
  const std::vector<Point> points = read_points(work / "a.ply");
  std::vector<double> records, expected;
  std::size_t own = 0, refused = 0, averaged = 0;
  double share = 0;
  for (const Point& point : points) {
    records.push_back(point.record);
    share += double{point.share};
    const bool is_own = point.x == 7 && point.y == 27;
    CHECK((point.kind == 0) == is_own);
    if (is_own) {
      ++own;
      CHECK(point.colour == std::array<unsigned char, 3>{255, 0, 0});
    } else if (point.kind == 1) {
      ++averaged;
      CHECK(point.colour[0] == point.colour[2]);
      CHECK(point.paths > 0);
    } else {
      ++refused;
      CHECK(point.share == 0);
      CHECK(point.colour[0] != point.colour[2]);
    }
  }
  for (const auto& path : figures.at("paths")) {
    for (const auto& record : path.at("neighbors").at("record")) expected.push_back(record);
  }
  std::sort(expected.begin(), expected.end());
  expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
  CHECK(records == expected);
  CHECK(std::abs(share - 1) < 1e-4);  // nothing of this pixel bypasses its vertices
  CHECK(own == 4);
  CHECK(averaged > 10);
  CHECK(refused > 10);
}

TEST_CASE("In the point cloud fireflies have what they keep and what they give") {
  const Explained work;
  const nlohmann::json figures = work.figures(
      "--pixel 16,16 --block all --fit linear --fireflies spread --ply " + work / "a.ply");
  std::size_t giving = 0, listed = 0;
  double share = 0, given = 0;
  for (const Point& point : read_points(work / "a.ply", true)) {
    share += double{point.share};
    given += double{point.given};
    giving += point.kind == 3 ? 1u : 0u;
    if (point.kind == 3) CHECK(is_close(double{point.share}, double{point.given}));
    for (const auto& firefly : figures.at("fireflies")) {
      if (firefly.at("record") != point.record) continue;
      ++listed;
      CHECK(is_close(firefly.at("kept").get<double>(), double{point.kept}));
    }
  }
  const auto luminance = [&figures](const char* of) {
    const auto& c = figures.at("value").at(of);
    return 0.2126 * c[0].get<double>() + 0.7152 * c[1].get<double>() + 0.0722 * c[2].get<double>();
  };
  CHECK(listed == figures.at("fireflies").size());
  CHECK(giving > 0);
  CHECK(std::abs(share - 1) < 1e-4);
  CHECK(std::abs(given - luminance("given") / luminance("filtered")) < 1e-5);
}

TEST_CASE("Tables have the rows asked for; with --all every path has its vertex") {
  const Explained work;
  const auto lines = [](const std::string& text) {
    return std::count(text.begin(), text.end(), '\n');
  };
  const std::string few = work.explain("--pixel 3,9 --top 2").out;
  const std::string more = work.explain("--pixel 3,9").out;
  const std::string all = work.explain("--pixel 3,9 --all").out;
  CHECK(lines(few) < lines(more));
  CHECK(lines(more) <= 50);
  CHECK(lines(all) > 60);
  CHECK(few.find("  and 2 more\n") != std::string::npos);  // the pixel has 4 paths
  CHECK(all.find(" more\n") == std::string::npos);
  CHECK(all.find("    x (") != std::string::npos);
  CHECK(more.find("    x (") == std::string::npos);
  std::size_t widest = 0, begin = 0;
  for (std::size_t end = 0; (end = more.find('\n', begin)) != std::string::npos; begin = end + 1) {
    widest = std::max(widest, end - begin);
  }
  CHECK(widest <= 120);
}

TEST_CASE("Paths without vertex are explained, and one path by its number") {
  const Explained work;
  work.render("sky.pvb", "arcade.json --size 32x32 --passes 2");
  const Outcome sky = work.explain("--pixel 30,11", "sky.pvb");
  CHECK(sky.code == 0);
  CHECK(sky.out.find("2 without vertex") != std::string::npos);
  CHECK(sky.out.find("vertices   none: nothing is averaged") != std::string::npos);
  const Outcome one = work.explain("--path 1300");
  CHECK(one.code == 0);
  CHECK(one.out.find("path 1300, pixel 20,8 of camera \"front\"") != std::string::npos);
  CHECK(one.out.find("too few paths") != std::string::npos);
}

TEST_CASE("Every mistake with psf explain is one line and leaves nothing behind") {
  const Explained work;
  work.render("two.pvb", "two-rooms.json --size 16x16 --passes 1 --channels normal,reflectance");
  const std::size_t files = work.file_count();
  struct Mistake {
    std::string options;
    int code;
    std::string message;
    std::string file = "a.pvb";
  };
  const std::vector<Mistake> mistakes = {
      {"", 2, "--pixel X,Y or --path I"},
      {"--pixel 1,2 --path 3", 2, "--path"},
      {"--pixel 32,0", 2, "outside the picture of camera \"front\", 0,0 to 31,31"},
      {"--pixel 0", 2, "'0' is no pixel"},
      {"--pixel 0,-1", 2, "'0,-1' is no pixel"},
      {"--pixel 0,1,2", 2, "is no pixel"},
      {"--path 4096", 2, "not among the paths 0 to 4095"},
      {"--pixel 1,2 --passes 2:9", 2, "has passes 0:4"},
      {"--pixel 1,2 --camera left", 2, "has no camera \"left\", but front"},
      {"--pixel 1,2 --all --top 3", 2, "--top"},
      {"--pixel 1,2 --radus 3", 2, "unknown option --radus"},
      {"--pixel 1,2 --json " + work / "nowhere/x.json", 4, "does not exist, create it first"},
      {"--pixel 1,2 --ply " + work / "nowhere/x.ply", 4, "does not exist, create it first"},
      {"--pixel 1,2 --estimator hash", 2, "only those that average over a ball"},
      {"--pixel 1,2 --estimator disk --fit linear", 2, "--fit"},
      {"--pixel 1,2 --estimator hash --fireflies spread", 2, "--fireflies"},
      {"--pixel 1,2", 4, "b.pvb: ", "b.pvb"},
      {"--pixel 1,2 --visibility", 3, "has no channel visibility, which --visibility needs",
       "two.pvb"},
  };
  for (const Mistake& mistake : mistakes) {
    const Outcome outcome = work.explain(mistake.options, mistake.file);
    INFO(mistake.options << "\n" << outcome.err);
    CHECK(outcome.code == mistake.code);
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    CHECK(outcome.err.find(mistake.message) != std::string::npos);
    CHECK(outcome.out.empty());
    CHECK(work.file_count() == files);
  }
}
