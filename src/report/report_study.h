// Reads and checks a study in a folder, with the names of its pictures.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "study/study_file.h"

namespace psf::report {

struct StudyPicture {
  std::string id;          // id of the row or series, or "unfiltered", "reference"
  std::size_t point = 0;   // for a picture of a series: index into its points
  bool has_point = false;  // the picture belongs to a point of a series
  std::string file;        // path, with the folder
};

struct Study {
  std::string folder;       // without its path, for headings
  std::string scene, dump;  // for the title
  study::Json json;         // as read, except that file names are without their folders
  // In the order of their importance: reference, unfiltered, the best row by the first metric, the
  // next best, and so on; in a convergence study the last n comes before smaller ones. Those of an
  // ablation are in the order of its rows.
  std::vector<StudyPicture> pictures;
};

// Reads the studies of a folder: its sweep.json, converge.json and ablate.json, in this order; where
// it has none, those of the folders in it, by name. Throws Error{io} where there is no study,
// Error{bad_input} where a file is not what psf sweep, converge or ablate writes.
[[nodiscard]] std::vector<Study> read_studies(const std::string& folder);

}  // namespace psf::report
