// A study as it was written to a folder, checked, and the pictures that it names.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "study/study_file.h"

namespace psf::study {

struct StudyPicture {
  std::string id;          // of the row or series; "unfiltered", "reference"
  std::size_t point = 0;   // of a series: index into its points
  bool has_point = false;  // of a series
  std::string file;        // with its folder
};

struct Study {
  std::string folder;       // without its path, for headings
  std::string scene, dump;  // for the title
  Json json;                // as read, but that file names have lost their folders
  // What to show first comes first: reference, unfiltered, the best row, the next best, ... by the
  // first metric; of a convergence study the last n before smaller ones.
  std::vector<StudyPicture> pictures;
};

// The studies of one folder: its sweep.json, its converge.json, or both in this order; where it has
// neither, those of the folders in it, by name. Throws Error{io} where there is none,
// Error{bad_input} where one is not what the verb writes.
[[nodiscard]] std::vector<Study> read_studies(const std::string& folder);

}  // namespace psf::study
