#include "report/report_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>

#include "core/error.h"
#include "report/report_json.h"

namespace psf::report {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t kLargestJson = std::uintmax_t{256} << 20;  // bytes

struct Ranked {
  StudyPicture picture;
  int first = 0;     // pictures that always come first: smaller is earlier
  double error = 0;  // then the smaller, of the first metric
};

class Checker {
 public:
  Checker(const std::string& folder, const JsonPlace& root) : folder_(folder), root_(root) {}

  std::vector<StudyPicture> sweep() {
    metrics();
    input(root_.member("input"));
    reference();
    if (const auto unfiltered = root_.optional_member("unfiltered")) {
      unfiltered->member("metrics").expect_numbers();
      add("unfiltered", *unfiltered, 1, 0);
    }
    const JsonPlace rows = root_.member("rows");
    if (rows.size() == 0) rows.fail("at least one row");
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const JsonPlace row = rows.element(k);
      const std::string id = new_id(row);
      row.member("parameters").expect_texts();
      row.optional_numbers("radius");
      for (const char* name : {"neighbors", "seconds", "shared"}) row.optional_number(name);
      add(id, row, 2, error_of(row));
    }
    return sorted();
  }

  std::vector<StudyPicture> ablate() {
    if (root_.member("metrics").size() > 0) metrics();
    input(root_.member("input"));
    reference();
    const JsonPlace rows = root_.member("rows");
    if (rows.size() == 0) rows.fail("at least one row");
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const JsonPlace row = rows.element(k);
      const std::string id = new_id(row);
      for (const char* name : {"part", "label"}) (void)row.member(name).text();
      (void)row.member("passes").number();
      if (const auto parameters = row.optional_member("parameters")) parameters->expect_texts();
      row.member("metrics").expect_numbers();
      for (const char* name : {"mean", "change", "neighbors", "seconds"}) row.optional_number(name);
      add(id, row, 2, static_cast<double>(k));  // in their order: one follows from another
    }
    return sorted();
  }

  std::vector<StudyPicture> converge() {
    metrics();
    const JsonPlace inputs = root_.member("inputs");
    if (inputs.size() == 0) inputs.fail("at least one dump");
    for (std::size_t k = 0; k < inputs.size(); ++k) input(inputs.element(k));
    reference();
    const JsonPlace n = root_.member("n");
    if (n.size() == 0) n.fail("at least one number of passes");
    for (std::size_t k = 0; k < n.size(); ++k) {
      const double before = k == 0 ? 0 : n.element(k - 1).number();
      if (!(n.element(k).number() > before)) n.element(k).fail("numbers that rise");
    }
    const JsonPlace list = root_.member("series");
    if (list.size() == 0) list.fail("at least one series");
    for (std::size_t k = 0; k < list.size(); ++k) series(list.element(k), n);
    if (const auto speedups = root_.optional_member("speedups")) {
      for (std::size_t k = 0; k < speedups->size(); ++k) {
        const JsonPlace speedup = speedups->element(k);
        (void)speedup.member("id").text();
        for (const char* name : {"n", "equal_time", "equal_error"}) speedup.optional_number(name);
      }
    }
    return sorted();
  }

 private:
  void metrics() {
    const JsonPlace list = root_.member("metrics");
    if (list.size() == 0) list.fail("at least one metric");
    for (std::size_t k = 0; k < list.size(); ++k) {
      const std::string name = list.element(k).member("name").text();
      if (k == 0) {
        metric_ = name;
        const auto lower = list.element(k).optional_member("lower_is_better");
        sign_ = lower && lower->value() == false ? -1 : 1;
      }
    }
  }

  static void input(const JsonPlace& place) {
    (void)place.member("file").text();
    (void)place.member("scene").text();
  }

  void reference() {
    if (const auto place = root_.optional_member("reference")) add("reference", *place, 0, 0);
  }

  std::string new_id(const JsonPlace& place) {
    const JsonPlace id = place.member("id");
    if (!ids_.insert(id.text()).second) id.fail("an id that no other has");
    return id.text();
  }

  void series(const JsonPlace& place, const JsonPlace& n) {
    const std::string id = new_id(place);
    if (const auto parameters = place.optional_member("parameters")) parameters->expect_texts();
    const JsonPlace points = place.member("points");
    if (points.size() != n.size()) points.fail(fmt::format("{} points, one an n", n.size()));
    for (std::size_t k = 0; k < points.size(); ++k) {
      const JsonPlace point = points.element(k);
      if (point.member("n").number() != n.element(k).number()) {
        point.member("n").fail(fmt::format("{}", n.element(k).number()));
      }
      check_parts(point);
      const double error = error_of(point);
      const bool last = k + 1 == points.size();
      const int from_last = static_cast<int>(points.size() - k);
      add(id, point, id == "unfiltered" && last ? 1 : 1 + from_last, error, k);
    }
  }

  static void check_parts(const JsonPlace& point) {
    for (const char* name : {"slope", "seconds"}) point.optional_numbers(name);
    for (const char* name : {"neighbors", "radius_px", "mse", "bias_sq", "variance"}) {
      point.optional_number(name);
    }
    for (const char* name : {"bias_sq_ci", "variance_ci"}) {
      const auto interval = point.optional_member(name);
      if (!interval) continue;
      if (interval->size() != 2) interval->fail("two numbers or null");
      for (std::size_t k = 0; k < 2; ++k) (void)interval->element(k).number_or_null();
    }
  }

  [[nodiscard]] double error_of(const JsonPlace& place) const {
    const JsonPlace metrics = place.member("metrics");
    metrics.expect_numbers();
    const auto value = metrics.optional_member(metric_);
    return value ? sign_ * value->number() : std::numeric_limits<double>::infinity();
  }

  void add(const std::string& id, const JsonPlace& place, int first, double error,
           std::optional<std::size_t> point = {}) {
    const auto name = place.optional_member("picture");
    if (!name) return;
    const fs::path file = name->text();
    const bool climbs = std::find(file.begin(), file.end(), "..") != file.end();
    if (file.empty() || file.is_absolute() || climbs) name->fail("a file name in this folder");
    pictures_.push_back(
        {{id, point.value_or(0), point.has_value(), (fs::path(folder_) / file).string()},
         first,
         error});
  }

  std::vector<StudyPicture> sorted() {
    std::stable_sort(pictures_.begin(), pictures_.end(), [](const Ranked& a, const Ranked& b) {
      return a.first != b.first ? a.first < b.first : a.error < b.error;
    });
    std::vector<StudyPicture> result;
    for (Ranked& ranked : pictures_) result.push_back(std::move(ranked.picture));
    return result;
  }

  std::string folder_;
  JsonPlace root_;
  std::string metric_;
  double sign_ = 1;
  std::set<std::string> ids_;
  std::vector<Ranked> pictures_;
};

std::string name_of(const fs::path& path) {
  return path.has_filename() ? path.filename().string() : path.parent_path().filename().string();
}

// A report is passed on: whose machine the files lay on is nobody's business.
void strip_folder(study::Json& object) {
  if (object.is_object() && object.contains("file") && object["file"].is_string()) {
    object["file"] = name_of(object["file"].get<std::string>());
  }
}

Study read_study(const std::string& folder, const std::string& kind) {
  const std::string path = (fs::path(folder) / (kind + ".json")).string();
  const std::string remedy = "write it anew with psf " + kind + " -o " + folder;
  if (fs::file_size(path) > kLargestJson) {
    throw Error(ErrorCode::limit, path + ": is larger than 256 MiB; study fewer parameters");
  }
  Study study;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(ErrorCode::io, path + ": cannot be read");
  try {
    study.json = study::Json::parse(in);
  } catch (const study::Json::parse_error& error) {
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: is no JSON at byte {}; {}", path, error.byte, remedy));
  }
  const JsonPlace root(study.json, path, remedy);
  if (root.member("kind").text() != kind) root.member("kind").fail("\"" + kind + "\"");
  if (root.member("format").number() != study::kStudyFormat) {
    root.member("format").fail(
        fmt::format("{}, what this version of psf reads", study::kStudyFormat));
  }
  Checker checker(folder, root);
  study.pictures = kind == "sweep"      ? checker.sweep()
                   : kind == "converge" ? checker.converge()
                                        : checker.ablate();

  study.folder = name_of(fs::weakly_canonical(folder));
  const bool has_several = kind == "converge";
  if (has_several) {
    for (study::Json& input : study.json["inputs"]) strip_folder(input);
  } else {
    strip_folder(study.json["input"]);
  }
  if (study.json.contains("reference")) strip_folder(study.json["reference"]);
  const study::Json& input = has_several ? study.json["inputs"][0] : study.json["input"];
  study.scene = input["scene"].get<std::string>();
  study.dump = input["file"].get<std::string>();
  return study;
}

std::vector<Study> studies_in(const std::string& folder) {
  std::vector<Study> studies;
  for (const char* kind : {"sweep", "converge", "ablate"}) {
    if (fs::exists(fs::path(folder) / (std::string(kind) + ".json"))) {
      studies.push_back(read_study(folder, kind));
    }
  }
  return studies;
}

}  // namespace

std::vector<Study> read_studies(const std::string& folder) {
  if (!fs::is_directory(folder)) throw Error(ErrorCode::io, folder + ": is no folder");
  std::vector<Study> studies = studies_in(folder);
  if (!studies.empty()) return studies;
  std::set<std::string> inside;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory()) inside.insert(entry.path().string());
  }
  for (const std::string& one : inside) {
    for (Study& study : studies_in(one)) studies.push_back(std::move(study));
  }
  if (studies.empty()) {
    throw Error(ErrorCode::io,
                folder +
                    ": has no sweep.json, converge.json or ablate.json; make one with psf "
                    "sweep, converge or ablate and -o " +
                    folder);
  }
  return studies;
}

}  // namespace psf::report
