#include "study/tune_file.h"

#include <algorithm>
#include <span>

namespace psf::study {
namespace {

Json row_to_json(const TuneRow& row) {
  return {{"parameters", to_json(row.parameters)},
          {"error", row.error},
          {"standard_error", row.standard_error},
          {"bias_sq", row.bias_sq},
          {"variance", row.variance},
          {"neighbors", row.neighbors},
          {"sigmas_above_least", row.sigmas_above_least},
          {"may_be_better", row.may_be_better}};
}

}  // namespace

std::vector<const TuneRow*> by_error(const TuneResult& tuning) {
  std::vector<const TuneRow*> rows;
  for (const TuneRow& row : tuning.rows) rows.push_back(&row);
  std::stable_sort(rows.begin(), rows.end(),
                   [](const TuneRow* a, const TuneRow* b) { return a->error < b->error; });
  return rows;
}

std::size_t may_be_better(const TuneResult& tuning) {
  return static_cast<std::size_t>(
      std::count_if(tuning.rows.begin(), tuning.rows.end(),
                    [](const TuneRow& row) { return row.may_be_better; }));
}

Json to_json(const TuneResult& tuning, const run::Dump& dump, const TuneRequest& request,
             const std::string& version) {
  Json rows = Json::array();
  for (const TuneRow* row : by_error(tuning)) rows.push_back(row_to_json(*row));
  const formats::CameraInfo& camera = dump.metadata().cameras[request.camera];
  return {{"kind", "tune"},
          {"format", kStudyFormat},
          {"version", version},
          {"input", describe_input(dump, request.passes, request.camera)},
          {"epsilon", request.epsilon},
          {"unfiltered", tuning.unfiltered},
          {"u_variance", tuning.u_variance},
          {"u_covariance", tuning.u_covariance},
          {"noise", describe_noise(std::span(&tuning.noise, 1), std::span(&camera, 1))},
          {"constant", tuning.constant},
          {"correlation", tuning.correlation},
          {"independent_paths", tuning.has_independent_paths},
          {"parts", tuning.parts},
          {"sure", may_be_better(tuning) == 0},
          {"best", row_to_json(tuning.rows[tuning.best])},
          {"rows", rows}};
}

}  // namespace psf::study
