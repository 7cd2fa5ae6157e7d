#include "psf/study_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/error.h"
#include "core/json_text.h"
#include "filter/parameters/text.h"
#include "psf/library.h"
#include "run/missing_terms.h"

namespace psf {

std::vector<filter::Parameters> to_filter(std::span<const Parameters> sets) {
  std::vector<filter::Parameters> all;
  for (const Parameters& set : sets) all.push_back(psf::to_filter(set));
  return all;
}

void fit(const run::Dump& dump, std::span<const Parameters> sets,
         std::vector<filter::Parameters>& rows, std::vector<std::string>& notes) {
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const std::string note =
        run::switch_off_missing(dump, {&rows[k], 1}, filter::asked_terms(sets[k].given()));
    if (!note.empty() && std::find(notes.begin(), notes.end(), note) == notes.end()) {
      notes.push_back(note);
    }
    static_cast<void>(dump.select(rows[k], false));
  }
}

std::vector<filter::Parameters> fitted(const run::Dump& dump, std::span<const Parameters> sets,
                                       std::vector<std::string>& notes) {
  std::vector<filter::Parameters> rows = to_filter(sets);
  fit(dump, sets, rows, notes);
  return rows;
}

void check_camera(const run::Dump& dump, std::size_t camera) {
  if (camera < dump.cameras().size()) return;
  throw Error(ErrorCode::usage, fmt::format("`camera`: there is no camera {}", camera));
}

void check_reference(const Picture& reference, const run::Dump& dump, std::size_t camera) {
  check_camera(dump, camera);
  const filter::CameraView& view = dump.cameras()[camera];
  if (reference.width == view.width && reference.height == view.height) return;
  throw Error(ErrorCode::bad_input,
              fmt::format("the reference has {} x {} pixels, the camera {} x {}", reference.width,
                          reference.height, view.width, view.height));
}

std::string file_text(const study::Json& json) {
  return core::json_file_text(json, 1);
}

std::string absolute(const std::string& path) {
  return std::filesystem::absolute(path).string();
}

}  // namespace psf
