// One HTML file that needs nothing else, from folders that psf sweep and psf converge wrote.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace psf::study {

struct ReportOptions {
  // Of every folder; the unfiltered picture, the reference and the best come first and always, then
  // the others from the best on.
  std::size_t max_pictures = 24;
  std::string version;  // of the program, for the page's title
};

struct ReportOutcome {
  std::size_t sections = 0;  // studies: a folder may hold a sweep and a convergence study
  std::size_t pictures = 0, pictures_left_out = 0;
  std::uint64_t bytes = 0;  // of the file
};

// Pictures are embedded as half floats (11 bits, 0.05 %), deflated. The same folders give the same
// bytes. Throws Error{io} for missing folders and pictures, Error{bad_input} for JSON that is no
// study, naming file, place and remedy; Error{interrupted}. The file appears only when whole.
ReportOutcome write_report(std::span<const std::string> folders, const std::string& path,
                           const ReportOptions& options);

}  // namespace psf::study
