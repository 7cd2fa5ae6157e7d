// What the studies of the library share: parameters that fit a dump, checks, and texts of files.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "filter/parameters/parameters.h"
#include "psf/parameters.h"
#include "psf/picture.h"
#include "run/dump.h"
#include "study/study_file.h"

namespace psf {

[[nodiscard]] std::vector<filter::Parameters> to_filter(std::span<const Parameters> sets);

// Switches off in `rows`, which are `sets`, what the dump lacks and was not asked for, and says so
// in `notes`. Throws where what was asked for is missing.
void fit(const run::Dump& dump, std::span<const Parameters> sets,
         std::vector<filter::Parameters>& rows, std::vector<std::string>& notes);
[[nodiscard]] std::vector<filter::Parameters> fitted(const run::Dump& dump,
                                                     std::span<const Parameters> sets,
                                                     std::vector<std::string>& notes);

// Throws Error{usage} where there is no such camera.
void check_camera(const run::Dump& dump, std::size_t camera);
// The same, and Error{bad_input} where the reference has another size than its picture.
void check_reference(const Picture& reference, const run::Dump& dump, std::size_t camera);

// As its file is written.
[[nodiscard]] std::string file_text(const study::Json& json);
// A name that holds when the working directory changes.
[[nodiscard]] std::string absolute(const std::string& path);

}  // namespace psf
