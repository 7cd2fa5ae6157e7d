// A sweep in its folder: sweep.json and sweep.csv, written anew after every traversal.
#pragma once

#include <string>

#include "study/study_file.h"
#include "study/sweep.h"

namespace psf::study {

class SweepFile {
 public:
  // What is fixed: see study_file.h.
  struct About {
    std::string version;
    Json input, reference, metrics;
  };
  // With `resume` takes over the rows that sweep.json has. Throws Error{usage} where the folder has
  // one and it is not resumed, Error{bad_input} where that is of another dump, reference or
  // metrics.
  SweepFile(std::string folder, About about, bool resume);

  [[nodiscard]] bool has(const filter::Parameters& parameters) const;
  [[nodiscard]] bool has_unfiltered() const { return !json_["unfiltered"].is_null(); }
  // "0001", of the next row.
  [[nodiscard]] std::string next_id() const;
  // Of the row that comes behind so many others.
  [[nodiscard]] static std::string id(std::size_t rows);

  // `picture`: a name in the folder, or empty.
  void add(const SweepRow& row, std::span<const Metric> metrics, const std::string& picture);
  void set_unfiltered(const Metrics& values, std::span<const Metric> metrics,
                      const std::string& picture);
  void set_reference_picture(const std::string& picture);

  void write() const;
  [[nodiscard]] const Json& json() const { return json_; }

 private:
  [[nodiscard]] std::string csv() const;

  std::string folder_;
  Json json_;
};

}  // namespace psf::study
