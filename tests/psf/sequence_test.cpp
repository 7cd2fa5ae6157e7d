// Sequences of the library through its own headers: frames filtered alone and with those around
// them, and their flicker. That the bytes are those of the commands is the test of the Python
// package.
#include <atomic>
#include <cmath>
#include <string>
#include <vector>

#include "catch.h"
#include "plane.h"
#include "psf/psf.h"
#include "read_text.h"
#include "temp_folder.h"

namespace {

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using psf::tests::kSide;
using psf::tests::Plane;
using psf::tests::TempFolder;

constexpr const char* kFrames = R"(, "frames": {"first": 7, "count": 4, "passes": 2})";

// Four frames of two passes each of one plane, under light that stays.
struct Flight {
  Flight() { psf::tests::write(path, Plane(8), 8, 0, kFrames); }
  TempFolder folder;
  std::string path = folder / "flight.pvb";
};

// Both colours of the plane as they are.
psf::Picture truth() {
  psf::Picture picture;
  picture.width = picture.height = kSide;
  for (const char* name : {"R", "G", "B"}) {
    psf::Layer layer{name, {}};
    const float scale = name[0] == 'R' ? 1.0f : name[0] == 'G' ? 0.5f : 2.0f;
    for (std::size_t i = 0; i < kSide * kSide; ++i) {
      layer.values.push_back((i % kSide < kSide / 2 ? 0.2f : 0.8f) * scale);
    }
    picture.layers.push_back(layer);
  }
  return picture;
}

std::vector<psf::Picture> filtered(const psf::Sequence& sequence, std::uint32_t window) {
  psf::FrameOptions options;
  options.window = window;
  std::vector<psf::Picture> pictures;
  for (const std::uint32_t frame : sequence.frames()) {
    pictures.push_back(
        sequence.filter(frame, psf::Parameters().set("r0", "2px"), options).pictures[0]);
  }
  return pictures;
}

std::string attribute(const psf::Picture& picture, const std::string& name) {
  for (const auto& [key, text] : picture.attributes) {
    if (key == name) return text;
  }
  return "";
}

}  // namespace

TEST_CASE("a frame alone is its passes of the dump") {
  const Flight flight;
  const psf::Sequence sequence(flight.path);
  CHECK(sequence.frames() == std::vector<std::uint32_t>{7, 8, 9, 10});
  CHECK(sequence.cameras()[0].name == "above");
  psf::FilterOptions passes;
  passes.passes = {4, 6};
  const psf::FilterResult frame = sequence.filter(9),
                          same = psf::Dump(flight.path).filter({}, passes);
  CHECK(frame.passes == 2);
  CHECK(frame.notes == same.notes);
  CHECK(frame.neighbors == same.neighbors);
  CHECK(frame.pictures[0].attributes == same.pictures[0].attributes);
  CHECK(frame.pictures[0].rgb() == same.pictures[0].rgb());
}

TEST_CASE("a window brings the vertices of the frames around, where the light is the same") {
  const Flight flight;
  const psf::Sequence sequence(flight.path);
  psf::FrameOptions options;
  options.window = 3;
  options.relit = "off";
  const psf::FilterResult alone = sequence.filter(8), shared = sequence.filter(8, {}, options);
  CHECK(shared.neighbors > 2.9 * alone.neighbors);  // three frames of as many vertices
  CHECK(sequence.filter(7, {}, options).neighbors < 2.1 * alone.neighbors);  // the first has two
  CHECK(shared.pictures[0].error(truth()) < alone.pictures[0].error(truth()));
  CHECK(attribute(shared.pictures[0], "psf:relit") == "off");
  CHECK(attribute(shared.pictures[0], "psf:positions") == "world");
  CHECK(attribute(alone.pictures[0], "psf:relit").empty());
  options.relit.clear();
  CHECK(sequence.filter(8, {}, options).neighbors < shared.neighbors);
  options.layers = false;
  CHECK(sequence.filter(8, {}, options).pictures[0].layers.size() == 3);
}

TEST_CASE("error and flicker of pictures are those of the formula, and a window has less") {
  const Flight flight;
  const psf::Sequence sequence(flight.path);
  const std::vector<psf::Picture> alone = filtered(sequence, 1), shared = filtered(sequence, 3);
  const std::vector<psf::Picture> right(4, truth());
  psf::FlickerOptions options;
  options.first_frame = 7;
  const std::vector<psf::PictureSequence> both = {{"", alone, "alone"}, {"", shared, "window 3"}};
  const psf::FlickerResult measured = psf::flicker(both, {"", right}, options);
  REQUIRE(measured.rows.size() == 2);
  double error = 0, flicker = 0;
  const std::vector<float> r = right[0].rgb();
  for (std::size_t k = 0; k < r.size(); ++k) {
    std::vector<double> e;
    for (const psf::Picture& picture : alone) {
      e.push_back((picture.rgb()[k] - r[k]) / std::sqrt(double{r[k]} * r[k] + 0.01));
      error += e.back() * e.back() / 4;
    }
    const double mean = (e[3] - e[0]) / 3;
    for (std::size_t f = 0; f < 3; ++f) flicker += std::pow(e[f + 1] - e[f] - mean, 2) / 2;
  }
  CHECK(measured.rows[0].error == Approx(error / static_cast<double>(r.size())));
  CHECK(measured.rows[0].flicker == Approx(flicker / static_cast<double>(r.size())));
  CHECK(measured.rows[0].left_out == 0);
  CHECK(measured.rows[1].label == "window 3");
  CHECK(measured.rows[1].error < measured.rows[0].error);
  CHECK(measured.rows[1].flicker < measured.rows[0].flicker);
  CHECK_THAT(measured.json,
             StartsWith("{\n  \"reference\": null,\n  \"first\": 7,\n  \"last\": 11"));
  measured.save(flight.folder / "sheet.png");
  CHECK(psf::tests::read_text(flight.folder / "sheet.png") ==
        std::string(measured.png.begin(), measured.png.end()));
}

TEST_CASE("pictures of files are those in memory, and no sheet goes over them") {
  const Flight flight;
  const std::vector<psf::Picture> pictures = filtered(psf::Sequence(flight.path), 1);
  const std::vector<psf::Picture> right(4, truth());
  const std::string files = flight.folder / "a.####.exr";
  for (std::size_t k = 0; k < 4; ++k) {
    pictures[k].save(flight.folder / "a.000" + std::to_string(k) + ".exr");
  }
  const std::vector<psf::PictureSequence> both = {{files, {}}, {"", pictures}};
  const psf::FlickerResult measured = psf::flicker(both, {"", right});
  CHECK(measured.rows[0].label == files);
  CHECK(measured.rows[0].error == measured.rows[1].error);
  CHECK(measured.rows[0].flicker == measured.rows[1].flicker);
  CHECK(psf::flicker(both, {files, {}}).rows[1].error == 0);
  CHECK_THROWS_WITH(measured.save(flight.folder / "a.0002.exr"),
                    ContainsSubstring("overwrite the input"));
}

TEST_CASE("mistakes about frames are errors that name what is wrong") {
  const Flight flight;
  psf::tests::write(flight.folder / "still.pvb", Plane(1), 1);
  CHECK_THROWS_WITH(psf::Sequence(flight.folder / "still.pvb"),
                    ContainsSubstring("tells of no frames"));
  const psf::Sequence sequence(flight.path);
  CHECK_THROWS_WITH(sequence.filter(11), ContainsSubstring("11 is none of them"));
  psf::FrameOptions options;
  options.window = 4;
  CHECK_THROWS_WITH(sequence.filter(7, {}, options), StartsWith("`window 4`: as many frames"));
  options = {};
  options.positions = "world";
  CHECK_THROWS_WITH(sequence.filter(7, {}, options), StartsWith("`positions`: is about other"));
  options.window = 3;
  options.relit = "nan";
  CHECK_THROWS_WITH(sequence.filter(7, {}, options), StartsWith("`relit`: 'nan': write a number"));
  const std::vector<psf::Picture> some(4, truth());
  const psf::PictureSequence right{"", some};
  const std::vector<psf::PictureSequence> few = {{"", std::span(some).first(3)}};
  CHECK_THROWS_WITH(psf::flicker(few, right),
                    StartsWith("pictures: 3 pictures for the frames 0:4"));
  CHECK_THROWS_WITH(psf::flicker({}, right), StartsWith("`pictures`: at least one sequence"));
  const std::vector<psf::Picture> none(4);
  const std::vector<psf::PictureSequence> empty = {{"", none}};
  CHECK_THROWS_WITH(psf::flicker(empty, {"", none}), ContainsSubstring("has no pixels"));
}

TEST_CASE("frames and flicker are ended by their thread's word") {
  const Flight flight;
  const psf::Sequence sequence(flight.path);
  const std::vector<psf::Picture> some(4, truth());
  const std::vector<psf::PictureSequence> one = {{"", some}};
  const std::atomic<bool> stopped{true};
  const psf::Interruptible here(stopped);
  CHECK_THROWS_WITH(sequence.filter(7), StartsWith("interrupted"));
  CHECK_THROWS_WITH(psf::flicker(one, {"", some}), StartsWith("interrupted"));
}
