// psf filter as a program: what it says of a run, and the memory it takes.
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>

#include "catch.h"
#include "command.h"
#include "film/image.h"

using psf::tests::Outcome;
using psf::tests::read_text;
using psf::tests::run;
using psf::tests::TempFolder;

namespace {

constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;

class Filtered {
 public:
  // A dump of the Cornell box.
  void render(const std::string& name, const std::string& options) const {
    const Outcome outcome = run("psf-render " PSF_SOURCE_DIR "/sample_data/cornell.json --quiet " +
                                options + " -o " + folder_ / name);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
  }
  [[nodiscard]] Outcome filter(const std::string& name, const std::string& options) const {
    return run("psf filter " + folder_ / name + " --quiet -o " + folder_ / "out.exr --json " +
               folder_ / "out.json " + options);
  }
  [[nodiscard]] nlohmann::json figures(const std::string& name, const std::string& options) const {
    const Outcome outcome = filter(name, options);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return nlohmann::json::parse(read_text(folder_ / "out.json"));
  }
  [[nodiscard]] psf::film::Image image() const { return psf::film::read_exr(folder_ / "out.exr"); }
  [[nodiscard]] std::vector<psf::Rgb> picture() const { return image().rgb(); }
  [[nodiscard]] std::string bytes() const { return read_text(folder_ / "out.exr"); }
  [[nodiscard]] bool has_picture() const { return std::filesystem::exists(folder_ / "out.exr"); }

 private:
  TempFolder folder_;
};

}  // namespace

TEST_CASE("psf filter counts the pairs in the ball, and who refuses them, only when asked") {
  const Filtered work;
  work.render("a.pvb", "--size 32x32 --passes 2");
  const nlohmann::json without = work.figures("a.pvb", ""),
                       with = work.figures("a.pvb", "--refusals");
  CHECK(without.at("candidates").is_null());
  CHECK(without.at("refused").is_null());
  CHECK(with.at("candidates") >= with.at("neighbors").at("total"));
  CHECK(with.at("refused").at("normal").is_number());
  CHECK(with.at("neighbors") == without.at("neighbors"));
  CHECK(work.filter("a.pvb", "").out.find("in the ball") == std::string::npos);
  const std::string text = work.filter("a.pvb", "--refusals").out;
  CHECK(text.find(" in the ball") != std::string::npos);
  CHECK(text.find("refused    ") != std::string::npos);
}

TEST_CASE("psf filter --max-memory gives up reading ahead, then refuses and names what fits") {
  const Filtered work;
  work.render("a.pvb", "--size 128x128 --passes 12");
  const std::string options = "--threads 2 --block 4passes --r0 2px ";
  const nlohmann::json free = work.figures("a.pvb", options).at("memory");
  const auto picture = work.picture();
  CHECK(free.at("blocks") == 2);
  const auto limit = [](std::uint64_t bytes) { return "--max-memory " + std::to_string(bytes); };
  const std::uint64_t two = free.at("estimate"), block = free.at("block");
  const nlohmann::json bound = work.figures("a.pvb", options + limit(two - 1)).at("memory");
  CHECK(bound.at("blocks") == 1);
  CHECK(bound.at("estimate") == two - block);
  CHECK(work.picture() == picture);

  const Filtered fresh;
  fresh.render("a.pvb", "--size 128x128 --passes 12");
  const Outcome refused = fresh.filter("a.pvb", options + limit(two - block - 1));
  INFO(refused.err);
  CHECK(refused.code == 5);
  CHECK(refused.out.empty());
  CHECK(std::count(refused.err.begin(), refused.err.end(), '\n') == 1);
  CHECK(refused.err.find("a.pvb: --block 4passes takes up to ") != std::string::npos);
  CHECK(refused.err.find("; --block 3passes would fit, with ") != std::string::npos);
  CHECK_FALSE(fresh.has_picture());
  CHECK(fresh.filter("a.pvb", options + "--block 3passes " + limit(two - block - 1)).code == 2);
  CHECK(fresh.filter("a.pvb", "--threads 2 --block 3passes " + limit(two - block - 1)).code == 0);
  CHECK(fresh.filter("a.pvb", "--max-memory 1M").err.find("no block would fit") !=
        std::string::npos);
  CHECK(fresh.filter("a.pvb", "--max-memory 1G").code == 0);
  CHECK(fresh.filter("a.pvb", "--max-memory much").code == 2);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they take their own
TEST_CASE("psf filter never takes more memory than it said, however long the file") {
  const Filtered work;
  work.render("short.pvb", "--size 128x128 --passes 32");
  work.render("long.pvb", "--size 128x128 --passes 128");
  for (const std::string options :
       {"--block 16passes --threads 1 --no-weights", "--block 2^18 --threads 2 --gloss off",
        "--block 16passes --threads 2 --gloss off --demodulate --iterations 2 --sources 1/4"}) {
    std::uint64_t estimate[2];
    for (const std::size_t which : {0u, 1u}) {
      const nlohmann::json memory =
          work.figures(which == 0 ? "short.pvb" : "long.pvb", "--r0 1px " + options).at("memory");
      INFO(options << "\n" << memory.dump(2));
      estimate[which] = memory.at("estimate");
      CHECK(memory.at("peak") <= estimate[which]);
      CHECK(memory.at("blocks").get<std::uint64_t>() * memory.at("block").get<std::uint64_t>() +
                memory.at("filter").get<std::uint64_t>() <=
            3 * memory.at("stored_block").get<std::uint64_t>());
      CHECK(memory.at("peak_process") >= memory.at("peak"));
    }
    // But for what is kept of each of the 96 passes more.
    CHECK(estimate[1] <= estimate[0] + 96 * 96);
  }
}

TEST_CASE("a block of 2^24 records is filtered within 16 GB, twice the passes in twice the time",
          "[.][long]") {
  const Filtered work;
  work.render("a.pvb", "--size 1024x1024 --passes 16");
  const nlohmann::json one = work.figures("a.pvb", "--block all --r0 1px");
  const nlohmann::json& memory = one.at("memory");
  INFO(memory.dump(2));
  CHECK(one.at("records") == 1 << 24);
  CHECK(one.at("blocks") == 1);
  CHECK(one.at("neighbors").at("mean") > 5);
  CHECK(memory.at("peak") <= memory.at("estimate"));
  CHECK(memory.at("peak_process") <= 16000 * kMebibyte);
  // An average keeps the light: what goes in comes out, but for the noise of its weights.
  const psf::film::Image image = work.image();
  for (const std::string channel : {"R", "G", "B"}) {
    const auto sum = [&image](const std::string& name) {
      const std::vector<float>& values = *image.find(name);
      return std::accumulate(values.begin(), values.end(), 0.0);
    };
    CHECK(sum(channel) == Approx(sum("unfiltered-input." + channel)).epsilon(0.01));
  }
  // Without the writing, which does not grow; the best of three.
  const auto seconds = [&work](const std::string& passes) {
    double best = 1e30;
    for (int k = 0; k < 3; ++k) {
      const nlohmann::json time = work.figures("a.pvb", "--passes " + passes).at("seconds");
      best = std::min(best, time.at("total").get<double>() - time.at("write").get<double>());
    }
    return best;
  };
  CHECK(seconds(":16") <= 2.1 * seconds(":8"));
}
#endif

TEST_CASE("What an EXR holds beside the picture is what --layers chooses, and the pixels stay") {
  const Filtered work;
  work.render("a.pvb", "--size 24x16 --passes 2");
  const auto channels = [&](const std::string& options) {
    INFO(options);
    REQUIRE(work.filter("a.pvb", options).code == 0);
    std::vector<std::string> names;
    for (const auto& layer : work.image().layers) names.push_back(layer.channel);
    return names;
  };
  using Names = std::vector<std::string>;
  const Names all = channels("");
  const std::vector<psf::Rgb> picture = work.picture();
  CHECK(all == Names{"B", "G", "R", "albedo.B", "albedo.G", "albedo.R", "neighbors.Y", "normal.X",
                     "normal.Y", "normal.Z", "radius.Y", "unfiltered-input.B", "unfiltered-input.G",
                     "unfiltered-input.R"});
  CHECK(channels("--layers all") == all);
  CHECK(channels("--layers none") == Names{"B", "G", "R"});
  CHECK(work.picture() == picture);
  CHECK(channels("--layers none --no-weights") == Names{"B", "G", "R"});
  CHECK(channels("--layers radius,normal") ==
        Names{"B", "G", "R", "normal.X", "normal.Y", "normal.Z", "radius.Y"});
  CHECK(work.picture() == picture);
  CHECK(channels("--layers neighbors,albedo,unfiltered-input").size() == 10);
  for (const std::string wrong : {"depth", "albedo,", "\"\""}) {
    const Outcome refused = work.filter("a.pvb", "--layers " + wrong);
    CHECK(refused.code == 2);
    CHECK(refused.err.find("--layers") != std::string::npos);
  }
}

TEST_CASE("a picture is the same bytes for any number of threads") {
  const Filtered work;
  work.render("a.pvb", "--size 70x600 --passes 1");
  REQUIRE(work.filter("a.pvb", "--threads 1").code == 0);
  const std::string one = work.bytes();
  for (const std::string threads : {"2", "5"}) {
    REQUIRE(work.filter("a.pvb", "--threads " + threads).code == 0);
    CHECK(work.bytes() == one);
  }
}
