// Makes one self-contained HTML file from folders that psf sweep, converge and ablate wrote.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace psf::report {

struct ReportOptions {
  // The most pictures of every folder. The unfiltered picture, the reference and the best are
  // always there and come first; then come the others from the best on.
  std::size_t max_pictures = 24;
  std::string version;  // version of the program, for the page's title
};

struct ReportOutcome {
  std::size_t sections = 0;  // number of studies; a folder may hold a sweep and a convergence study
  std::size_t pictures = 0, pictures_left_out = 0;
  std::uint64_t bytes = 0;  // size of the file
};

// Writes a report on the studies in `folders` to the file `path`, which appears only when whole.
// Pictures are embedded as half floats (11 bits, 0.05 %), deflated. The same folders give the same
// bytes. Throws Error{io} for missing folders and pictures, Error{bad_input} for JSON that is no
// study, naming file, place and remedy, and Error{interrupted}.
ReportOutcome write_report(std::span<const std::string> folders, const std::string& path,
                           const ReportOptions& options);

}  // namespace psf::report
