// What the tests of the estimators share: a run over records, and its result as bytes.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "filter/estimate.h"
#include "filter/radius.h"
#include "record_set.h"

namespace psf::tests {

// Every estimator that averages records.
inline std::vector<filter::Estimator> all_estimators() {
  std::vector<filter::Estimator> all;
  for (std::size_t k = 0; k < filter::estimators().size(); ++k) {
    if (filter::estimators()[k].is_of_photons) continue;
    all.push_back(static_cast<filter::Estimator>(k));
  }
  return all;
}
inline std::string name_of(filter::Estimator estimator) {
  return std::string(filter::info(estimator).name);
}

inline const std::vector<filter::CameraView> kCamera = {{30, 30, 0.05}};

struct EstimatorRun {
  filter::Parameters parameters;
  std::vector<filter::CameraView> cameras = kCamera;
  double n = 1;
  std::uint64_t first_path = 0;
  double passes = 1;  // number of passes of the block

  explicit EstimatorRun(const filter::Parameters& chosen) : parameters(chosen) {}
  explicit EstimatorRun(filter::Estimator estimator, double r0 = 0.3) {
    parameters.estimator = estimator;
    parameters.radius = {r0, filter::RadiusBasis::distance};
  }
  [[nodiscard]] filter::Estimates operator()(const RecordSet& set) const {
    const filter::Block block{first_path, n, passes, cameras};
    std::vector<float> radius;
    filter::radii(parameters.radius, set.view(), block, radius);
    return filter::estimate(set.view(), radius, block, parameters);
  }
};

inline bool same_bytes(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  if (a.empty() || b.empty()) return a.empty() && b.empty();
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Rgb)) == 0;
}

// Two sheets of 400 records each in the unit square, the first in y = 0 with normal (0, 1, 0) and
// c = 100, the second spanned by u and v from `offset` with `normal` and c = 0.
inline RecordSet two_sheets(const Vec3& normal, const Vec3& u, const Vec3& v, const Vec3& offset) {
  RecordSet set(800);
  for (std::size_t k = 0; k < set.size(); ++k) {
    const float s = static_cast<float>(k % 20) / 20, t = static_cast<float>(k % 400 / 20) / 20;
    set.position[k] = k >= 400 ? offset + v * s + u * t : Vec3(s, 0, t);
    if (k >= 400) set.normal[k] = normal;
    set.contribution[k] = k >= 400 ? Rgb(0) : Rgb(100);
  }
  return set;
}

}  // namespace psf::tests
