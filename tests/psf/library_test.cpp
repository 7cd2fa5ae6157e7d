// The library that is installed, through its own headers alone: what is written is read back,
// a file and arrays give the same picture, and errors say what is wrong. That its pictures are
// those of psf filter, byte for byte, is the test of the package.
#include <cstring>

#include "catch.h"
#include "plane.h"
#include "psf/psf.h"
#include "read_text.h"
#include "temp_folder.h"

namespace {

using Catch::Matchers::StartsWith;
using psf::tests::TempFolder;

using psf::tests::kAbove;
using psf::tests::kChannels;
using psf::tests::kSide;
using psf::tests::Plane;
using psf::tests::write;

}  // namespace

TEST_CASE("parameters are text by name, what is not set is the default") {
  psf::Parameters parameters;
  CHECK(parameters.get("r0") == "8px");
  parameters.set("r0", "12px").set("normal", "off");
  CHECK(parameters.get("r0") == "12px");
  CHECK(parameters.get("normal") == "off");
  CHECK(parameters.get("gloss") == "0.8");
  CHECK(parameters.no_weights().get("gloss") == "off");
  CHECK(psf::Parameters::help().size() == 21);
  CHECK_THROWS_WITH(parameters.set("r1", "2"), StartsWith("there is no parameter 'r1'"));
  CHECK_THROWS_WITH(parameters.set("r0", "x"), StartsWith("`r0`: 'x' is no radius"));
  CHECK(parameters.get("r0") == "12px");
}

TEST_CASE("what is written is read back, and grows") {
  const TempFolder folder;
  const Plane plane(3);
  write(folder / "a.pvb", plane, 3);
  const psf::Dump dump(folder / "a.pvb");
  CHECK(dump.passes() == 3);
  CHECK(dump.records() == 3 * kSide * kSide);
  CHECK(dump.closed());
  REQUIRE(dump.cameras().size() == 1);
  CHECK(dump.cameras()[0].name == "above");
  CHECK(dump.cameras()[0].width == kSide);
  REQUIRE(dump.channels().size() == kChannels.size());
  CHECK(dump.channels()[1].name == "throughput");
  std::vector<float> some(3 * 10);
  dump.read_floats("contribution", 500, 10, some);
  CHECK(std::memcmp(some.data(), &plane.contribution[1500], some.size() * sizeof(float)) == 0);
  std::vector<std::uint32_t> pixels(10);
  dump.read("pixel", 570, 10, std::as_writable_bytes(std::span(pixels)));
  CHECK(std::equal(pixels.begin(), pixels.end(), &plane.pixel[570]));
  CHECK_THROWS_AS(dump.read_floats("roughness", 0, 1, some), psf::Error);
  CHECK_THROWS_AS(psf::Dump(folder / "none.pvb"), psf::Error);
}

TEST_CASE("a file and arrays give the same picture") {
  const TempFolder folder;
  const Plane plane(2);
  write(folder / "a.pvb", plane, 2);
  psf::Parameters parameters;
  parameters.set("block", "all").set("r0", "3px").set("reflectance", "0.1");
  const psf::FilterResult from_file = psf::Dump(folder / "a.pvb").filter(parameters);
  const psf::FilteredRecords in_memory = psf::filter_records(plane.records(), kAbove, parameters);
  REQUIRE(from_file.pictures.size() == 1);
  const psf::Picture& picture = from_file.pictures[0];
  REQUIRE(picture.layers.size() == in_memory.pictures[0].layers.size());
  for (std::size_t k = 0; k < picture.layers.size(); ++k) {
    INFO(picture.layers[k].name);
    CHECK(picture.layers[k].name == in_memory.pictures[0].layers[k].name);
    CHECK(picture.layers[k].values == in_memory.pictures[0].layers[k].values);
  }
  CHECK(from_file.sources == plane.pixel.size());
  CHECK(from_file.notes.size() == 1);  // no visibility, no directions for gloss

  // The radius of the second pass of two, and what it means for a square pattern.
  CHECK(in_memory.radius[0] == Approx(3.0 / kSide / std::pow(2, 1.0 / 6)));
  double mean = 0;
  for (const std::uint32_t m : in_memory.neighbors) mean += m;
  CHECK(mean / static_cast<double>(in_memory.neighbors.size()) == Approx(from_file.neighbors));
  // No average reaches over the border of the colours: rho in the mean, and far less noise.
  double left = 0, right = 0;
  for (std::size_t i = 0; i < plane.pixel.size(); ++i) {
    (plane.position[3 * i] < 0.5f ? left : right) += in_memory.c_bar[3 * i];
  }
  const auto half = static_cast<double>(plane.pixel.size()) / 2;
  CHECK(left / half == Approx(0.2).epsilon(0.1));
  CHECK(right / half == Approx(0.8).epsilon(0.1));
}

TEST_CASE("r0 0 gives the picture without filter, and errors are those of the formula") {
  const Plane plane(1);
  psf::Parameters none;
  none.set("r0", "0");
  const psf::Picture picture = psf::filter_records(plane.records(), kAbove, none).pictures[0];
  CHECK(picture.rgb() == picture.rgb("unfiltered-input."));
  psf::Picture reference = picture;
  for (psf::Layer& layer : reference.layers) {
    for (float& value : layer.values) value += 0.5f;
  }
  CHECK(picture.error(picture) == 0);
  CHECK(picture.error(reference, "mse") == Approx(0.25));
  CHECK_THROWS_WITH(picture.error(reference, "nothing"),
                    Catch::Matchers::ContainsSubstring("relMSE"));
  const TempFolder folder;
  picture.save(folder / "a.png");
  const std::vector<unsigned char> png = picture.png();
  CHECK(std::string(png.begin(), png.end()) == psf::tests::read_text(folder / "a.png"));
  CHECK(picture.png(1) != png);
}

TEST_CASE("a sweep measures every set as a filter run of its own does") {
  const TempFolder folder;
  const Plane plane(4);
  write(folder / "a.pvb", plane, 4);
  const psf::Dump dump(folder / "a.pvb");
  psf::Picture reference = dump.filter(psf::Parameters().set("r0", "0")).pictures[0];
  for (psf::Layer& layer : reference.layers) {
    for (std::size_t i = 0; i < layer.values.size(); ++i) {
      layer.values[i] = (i % kSide < kSide / 2 ? 0.2f : 0.8f) * (layer.name == "G" ? 0.5f : 1);
    }
  }
  std::vector<psf::Parameters> sets;
  for (const char* r0 : {"0", "2px", "4px"}) sets.push_back(psf::Parameters().set("r0", r0));
  const std::vector<std::string> metrics = {"relMSE", "MSE"};
  const std::vector<psf::SweepRow> rows = dump.sweep(reference, sets, metrics).rows;
  REQUIRE(rows.size() == 3);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const psf::Picture picture = dump.filter(sets[k]).pictures[0];
    REQUIRE(rows[k].errors.size() == 2);
    for (const auto& [metric, error] : rows[k].errors) {
      INFO(metric);
      CHECK(error == Approx(picture.error(reference, metric)).epsilon(1e-5));
    }
    CHECK(rows[k].parameters[0] == std::pair<std::string, std::string>("r0", sets[k].get("r0")));
  }
  CHECK(rows[1].errors[0].second < rows[0].errors[0].second);
}

TEST_CASE("mistakes are errors that name what is wrong") {
  const Plane plane(1);
  psf::Records records = plane.records();
  records.normal = records.normal.subspan(3);
  CHECK_THROWS_WITH(psf::filter_records(records, kAbove), StartsWith("`normal`: 1725 values"));
  records = plane.records();
  records.distance = {};
  CHECK_THROWS_WITH(psf::filter_records(records, kAbove),
                    Catch::Matchers::ContainsSubstring("distance"));
  const std::vector<psf::Camera> small = {{"small", 2, 2, 0.5}};
  CHECK_THROWS_WITH(psf::filter_records(plane.records(), small),
                    StartsWith("record 4: pixel 4 of camera 0, which has 2 x 2"));
  CHECK_THROWS_AS(psf::filter_records(plane.records(), {}), psf::Error);
  CHECK_THROWS_WITH(
      psf::filter_records(plane.records(), kAbove, psf::Parameters().set("material", "on")),
      Catch::Matchers::ContainsSubstring("material"));
  psf::Picture picture = psf::filter_records(plane.records(), kAbove).pictures[0];
  picture.layers[0].values.push_back(1);
  CHECK_THROWS_WITH(picture.rgb(), StartsWith("the layer R has 577 values"));
  CHECK_THROWS_WITH(psf::Picture().error(psf::Picture()), StartsWith("the picture has no pixels"));
  const TempFolder folder;
  const std::vector<psf::Channel> odd = {{"position", "f31", 3}};
  CHECK_THROWS_WITH(psf::DumpWriter(folder / "a.pvb", kAbove, odd),
                    Catch::Matchers::ContainsSubstring("there is no type f31"));
  CHECK(folder.file_count() == 0);
}

TEST_CASE("a picture with layers of the light is weighed by them") {
  psf::Picture picture;
  picture.width = 2;
  picture.height = 1;
  for (const char* colour : {"R", "G", "B"}) {
    picture.layers.push_back({colour, {3, 5}});
    picture.layers.push_back({std::string("key.") + colour, {1, 2}});
    picture.layers.push_back({std::string("sky.") + colour, {2, 3}});
  }
  CHECK(picture.light_layers().empty());
  CHECK_THROWS_WITH(picture.relight({}), StartsWith("the picture: has no layers of the light"));
  picture.attributes = {{"psf:light-layers", "key,sky"}};
  CHECK(picture.light_layers() == std::vector<std::string>{"key", "sky"});
  const psf::Picture relit = picture.relight({{"key", {2, 1, 0}}});
  CHECK(relit.rgb() == std::vector<float>{4, 3, 2, 7, 5, 3});
  CHECK(relit.relight({{"sky", {0, 0, 0}}}).rgb() == std::vector<float>{2, 1, 0, 4, 2, 0});
  CHECK_THROWS_WITH(picture.relight({{"moon", {1, 1, 1}}}),
                    StartsWith("the picture: has no layer moon of the light; there are key, sky"));
}
