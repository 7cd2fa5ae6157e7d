// The files sweep.json and sweep.csv of a sweep, written anew after every traversal.
#pragma once

#include <string>

#include "study/study_file.h"
#include "study/sweep.h"

namespace psf::study {

class SweepFile {
 public:
  // The parts that are the same for all rows; study_file.h makes them.
  struct About {
    std::string version;
    Json input, reference, metrics;
  };
  // With `resume` it takes over the rows of an existing sweep.json. Throws Error{usage} where there
  // is a sweep.json and `resume` is false, Error{bad_input} where it has another dump, reference or
  // metrics.
  SweepFile(std::string folder, About about, bool resume);

  [[nodiscard]] bool has(const filter::Parameters& parameters) const;
  [[nodiscard]] bool has_unfiltered() const { return !json_["unfiltered"].is_null(); }
  // The id of the next row, such as "0001".
  [[nodiscard]] std::string next_id() const;
  // The id of the row that follows `rows` others.
  [[nodiscard]] static std::string id(std::size_t rows);

  // Adds a row. `picture`: a file name in the folder, or empty.
  void add(const SweepRow& row, std::span<const metrics::Metric> metrics,
           const std::string& picture);
  void set_unfiltered(const metrics::Metrics& values, std::span<const metrics::Metric> metrics,
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
