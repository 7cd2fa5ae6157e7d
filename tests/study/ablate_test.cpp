// An ablation is what separate runs of the filter give, and says what it leaves out.
#include "study/ablate.h"

#include <algorithm>
#include <cmath>

#include "catch.h"
#include "core/error.h"
#include "run/memory.h"
#include "run/missing_terms.h"
#include "runs/filter_dump_setup.h"
#include "study/ablate_file.h"
#include "study/ablation_sheet.h"

namespace psf {
namespace {

using tests::kOne;
using tests::TempFolder;

struct Ablated {
  std::vector<study::AblationRow> rows;
  std::vector<std::vector<Rgb>> pictures;
  std::vector<std::string> notes;

  [[nodiscard]] std::vector<std::string> labels(study::AblationPart part) const {
    std::vector<std::string> list;
    for (const study::AblationRow& row : rows) {
      if (row.part == part) list.push_back(row.label);
    }
    return list;
  }
};

// `passes`: of 200 records, one a pixel.
std::string dump_of(const TempFolder& folder, std::size_t passes,
                    const std::vector<std::string>& without = {}) {
  std::string path = folder / (std::to_string(passes) + ".pvb");
  tests::write_dump(path, tests::random_records(200 * passes, 5, 0.1, kOne),
                    {kOne, std::vector<std::size_t>(passes, 200), without});
  return path;
}

study::AblateRequest request_of(const std::string& block = "1pass") {
  study::AblateRequest request;
  request.parameters = tests::default_run(block).parameters;
  return request;
}

Ablated ablated(const std::string& path, study::AblateRequest request) {
  Ablated result;
  const run::Dump dump(path);
  request.on_row = [&](const study::AblationRow&, const std::vector<Rgb>& picture) {
    result.pictures.push_back(picture);
  };
  result.rows = study::plan_ablation(dump, request, result.notes);
  study::ablate(dump, request, result.rows);
  REQUIRE(result.pictures.size() == result.rows.size());
  return result;
}

double mean_luminance(const std::vector<Rgb>& picture) {
  double sum = 0;
  for (const Rgb& c : picture) {
    sum += 0.2126 * double{c.x} + 0.7152 * double{c.y} + 0.0722 * double{c.z};
  }
  return sum / static_cast<double>(picture.size());
}

TEST_CASE("A row of an ablation is what the filter gives with its parameters, to the last bit") {
  const TempFolder folder;
  const std::string path = dump_of(folder, 5);
  study::AblateRequest request = request_of("2passes");
  request.passes.first = 1;
  const std::vector<Rgb> truth(200, Rgb(0.5f, 0.4f, 0.3f));
  const metrics::Reference reference(truth, 20);
  request.reference = &reference;
  const Ablated got = ablated(path, request);
  REQUIRE(got.rows.size() == 6 + 3 + 9);
  double base = 0;
  for (std::size_t k = 0; k < got.rows.size(); ++k) {
    const study::AblationRow& row = got.rows[k];
    INFO(study::name(row.part) << ": " << row.label);
    tests::FilterRequest alone;
    alone.parameters = row.parameters.value_or(request.parameters);
    alone.passes = {1, row.part == study::AblationPart::iterations ? 2u : 5u};
    const run::FilterResult outcome = run::filter_dump(run::Dump(path), alone);
    const film::Image image = outcome.pictures[0].image();
    CHECK(got.pictures[k] == image.rgb(row.parameters ? "" : "unfiltered-input."));
    const metrics::Metrics measured = reference.measure(got.pictures[k]);
    for (const metrics::Metric metric : metrics::kAllMetrics) {
      CHECK(row.metrics[metric] == measured[metric]);
    }
    if (!row.parameters) base = mean_luminance(got.pictures[k]);
    CHECK(row.mean == Approx(mean_luminance(got.pictures[k])).epsilon(1e-5));
    CHECK(row.change == Approx(row.mean / base - 1).margin(1e-5));
    if (row.parameters) CHECK(row.neighbors == outcome.statistics.mean_neighbors());
  }
}

TEST_CASE("Weights come one after another, blocks from one pass to all, and iterations up to 8") {
  const TempFolder folder;
  study::AblateRequest request = request_of();
  request.parameters.weights.plane = 0.4f;
  request.parameters.weights.material = true;
  const Ablated got = ablated(dump_of(folder, 4), request);
  using Part = study::AblationPart;
  CHECK(got.labels(Part::weights) ==
        std::vector<std::string>{"unfiltered", "no weights", "+ normal 0.95", "+ reflectance 0.05",
                                 "+ visibility", "+ plane 0.4", "+ material", "+ gloss 0.8"});
  CHECK(got.labels(Part::blocks) == std::vector<std::string>{"4 blocks of 1 pass",
                                                             "2 blocks of 2 passes",
                                                             "1 block of 4 passes"});
  CHECK(got.labels(Part::iterations).back() == "iteration 8");
  CHECK(got.notes.empty());

  // A term more each time: none may add neighbours, and the last row has all of them.
  std::vector<double> neighbors;
  for (const study::AblationRow& row : got.rows) {
    if (row.part == Part::weights && row.parameters) neighbors.push_back(row.neighbors);
  }
  CHECK(std::is_sorted(neighbors.rbegin(), neighbors.rend()));
  CHECK(neighbors.front() > neighbors.back());
  const auto last = std::find_if(got.rows.begin(), got.rows.end(),
                                 [](const auto& row) { return row.label == "+ gloss 0.8"; });
  CHECK(filter::describe(*last->parameters) == filter::describe(request.parameters));

  const auto blocks_of = [&](std::size_t passes) {
    return ablated(dump_of(folder, passes), request_of()).labels(Part::blocks);
  };
  CHECK(blocks_of(1) == std::vector<std::string>{"1 block of 1 pass"});
  CHECK(blocks_of(2) == std::vector<std::string>{"2 blocks of 1 pass", "1 block of 2 passes"});
  CHECK(blocks_of(5) == std::vector<std::string>{"5 blocks of 1 pass", "2 blocks of 3 and 2 passes",
                                                 "1 block of 5 passes"});
}

TEST_CASE("What a dump, an estimator or the memory does not allow is left out, and said") {
  const TempFolder folder;
  const std::string path = dump_of(folder, 4);
  const run::Dump lacking(dump_of(folder, 2, {"visibility", "roughness"}));
  study::AblateRequest request = request_of();
  CHECK_FALSE(run::switch_off_missing(lacking, {&request.parameters, 1}, 0).empty());
  std::vector<std::string> notes;
  const auto rows = study::plan_ablation(lacking, request, notes);
  CHECK(rows[3].label == "+ reflectance 0.05");
  CHECK(rows[4].part == study::AblationPart::blocks);

  request = request_of();
  filter::set_parameter(request.parameters, "estimator", "hash");
  const Ablated hashed = ablated(path, request);
  CHECK(hashed.labels(study::AblationPart::iterations).empty());
  REQUIRE(hashed.notes.size() == 1);
  CHECK(hashed.notes[0].starts_with("there are no iterations: "));

  // As much as one block of all passes needs, but for a byte.
  request = request_of();
  const run::Dump dump(path);
  filter::Parameters all = request.parameters;
  filter::set_parameter(all, "block", "4passes");
  constexpr std::uint64_t kPixel =
      run::CameraPictures::kBytesOfSums + run::CameraPictures::kBytesToWrite;
  request.max_memory =
      run::plan_memory(dump, dump.select(all, false), {all, 0, 4, {}, kPixel}).total() - 1;
  const Ablated small = ablated(path, request);
  CHECK(small.labels(study::AblationPart::blocks) ==
        std::vector<std::string>{"4 blocks of 1 pass", "2 blocks of 2 passes"});
  REQUIRE(small.notes.size() == 1);
  CHECK(small.notes[0].find("1 block of 4 passes") != std::string::npos);
  request.max_memory = 1000;
  CHECK_THROWS_AS(study::plan_ablation(dump, request, notes), Error);
}

TEST_CASE("An ablation's files have a row for each picture, with and without a reference") {
  const TempFolder folder;
  study::AblateRequest request = request_of();
  study::AblateReport report;
  report.rows = ablated(dump_of(folder, 2), request).rows;
  const study::Json json = study::to_json(report);
  CHECK(json["kind"] == "ablate");
  CHECK(json["reference"].is_null());
  REQUIRE(json["rows"].size() == report.rows.size());
  CHECK(json["rows"][0]["parameters"].is_null());
  CHECK(json["rows"][0]["neighbors"].is_null());
  CHECK(json["rows"][1]["parameters"]["normal"] == "off");
  CHECK(json["rows"][2]["parameters"]["normal"] == "0.95");
  CHECK(json["rows"][1]["metrics"].empty());
  report.measured = metrics::kAllMetrics;
  const std::string csv = study::to_csv(report);
  CHECK(csv.find("relMSE,MSE,SMAPE") != std::string::npos);
  CHECK(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')) ==
        report.rows.size() + 1);
}

TEST_CASE("A change that rounds to nothing has no sign") {
  study::AblationRow row;
  row.change = -0.00001;
  CHECK(study::change_text(row) == "+0.00%");
  row.change = -0.0123;
  CHECK(study::change_text(row) == "-1.23%");
}

TEST_CASE("The sheet of an ablation has a row of pictures for each part") {
  const TempFolder folder;
  const run::Dump dump(dump_of(folder, 4));
  study::AblateRequest request = request_of();
  std::vector<std::string> notes;
  const std::vector<Rgb> grey(200, Rgb(0.2f, 0.2f, 0.2f)), truth(200, Rgb(0.9f, 0.1f, 0.1f));
  const auto page = [&](const std::optional<study::AblationSheet::Truth>& shown) {
    study::AblationSheet sheet(dump, request, {}, shown);
    for (const study::AblationRow& row : study::plan_ablation(dump, request, notes)) {
      sheet.add(row, grey);
    }
    return sheet.sheet().draw();
  };
  const auto pixels_of = [](const film::Canvas& canvas, const film::Byte3& color) {
    std::size_t count = 0;
    for (std::size_t k = 0; k < canvas.values.size(); k += 3) {
      count += std::equal(color.begin(), color.end(),
                          canvas.values.begin() + static_cast<std::ptrdiff_t>(k))
                   ? 1u
                   : 0u;
    }
    return count;
  };
  // 20 x 10 pixels are shown 13 times as large.
  constexpr std::size_t kCellPixels = 20 * 13 * 10 * 13;
  const film::Byte3 shown_grey = {124, 124, 124};  // sRGB of 0.2
  CHECK(pixels_of(page({}), shown_grey) == (6 + 3 + 9) * kCellPixels);
  const film::Canvas with = page(study::AblationSheet::Truth{"truth.exr", truth});
  CHECK(pixels_of(with, shown_grey) == (6 + 3 + 9) * kCellPixels);
  CHECK(with.height > page({}).height);  // a line of the head more, and one of the errors
}

}  // namespace
}  // namespace psf
