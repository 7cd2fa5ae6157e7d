// What the tests of filter_dump share: runs, pictures, and pictures as the oracle has them.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "../filter/oracle.h"
#include "filter/parameters/text.h"
#include "run/filter_dump.h"
#include "temp_folder.h"
#include "write_dump.h"

namespace psf::tests {

using run::FilterRequest;

inline const std::vector<filter::CameraView> kOne = {{20, 10, 0.05}};
inline const std::vector<filter::CameraView> kTwo = {{16, 8, 0.05}, {8, 9, 0.1}};

inline FilterRequest default_run(const std::string& block = "1pass") {
  FilterRequest run;
  run.parameters.radius = {0.25, filter::RadiusBasis::distance};
  filter::set_parameter(run.parameters, "block", block);
  return run;
}

inline std::vector<film::Image> images(std::span<const run::CameraPictures> pictures) {
  std::vector<film::Image> list;
  for (const run::CameraPictures& one : pictures) list.push_back(one.image());
  return list;
}
inline std::vector<film::Image> filtered(const std::string& path, const FilterRequest& run) {
  return images(run::filter_dump(run::Dump(path), run).pictures);
}

inline bool same(const std::vector<film::Image>& a, const std::vector<film::Image>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t camera = 0; camera < a.size(); ++camera) {
    if (a[camera].layers.size() != b[camera].layers.size()) return false;
    for (std::size_t k = 0; k < a[camera].layers.size(); ++k) {
      if (a[camera].layers[k].channel != b[camera].layers[k].channel ||
          a[camera].layers[k].values != b[camera].layers[k].values) {
        return false;
      }
    }
  }
  return true;
}

// Means by camera and pixel, written from the equations.
struct Expected {
  std::vector<std::vector<Triple>> sum;
  std::vector<std::vector<double>> count;
  explicit Expected(const std::vector<filter::CameraView>& cameras) {
    for (const auto& camera : cameras) {
      sum.emplace_back(camera.width * camera.height);
      count.emplace_back(camera.width * camera.height);
    }
  }
  void add(const RecordSet& set, std::size_t i, const OracleResult& block, bool vertex) {
    const Triple u = triple(set.unfiltered[i]), alpha = triple(set.throughput[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      sum[set.camera[i]][set.pixel[i]][k] += u[k] + (vertex ? alpha[k] * block.c_bar[i][k] : 0);
    }
    count[set.camera[i]][set.pixel[i]] += 1;
  }
  [[nodiscard]] std::size_t differences(const std::vector<film::Image>& got) const {
    std::size_t wrong = 0;
    for (std::size_t camera = 0; camera < got.size(); ++camera) {
      const std::vector<Rgb> picture = got[camera].rgb();
      for (std::size_t pixel = 0; pixel < picture.size(); ++pixel) {
        for (std::size_t k = 0; k < 3; ++k) {
          const double mean =
              count[camera][pixel] == 0 ? 0 : sum[camera][pixel][k] / count[camera][pixel];
          const double value = double{picture[pixel][static_cast<int>(k)]};
          wrong += std::abs(value - mean) <= 1e-5 * (std::abs(mean) + 1e-3) ? 0u : 1u;
        }
      }
    }
    return wrong;
  }
};

// Every block of `bounds` by the oracle. n_of(block number, its end) is n of [radius].
template <typename N>
Expected by_oracle(const RecordSet& set, const filter::Parameters& parameters,
                   const std::vector<filter::CameraView>& cameras,
                   const std::vector<std::size_t>& bounds, N n_of) {
  Expected expected(cameras);
  for (std::size_t k = 0; k + 1 < bounds.size(); ++k) {
    const Oracle oracle(set, parameters, cameras, std::max(1.0, n_of(k, bounds[k + 1])), 0, 1);
    const OracleResult block = oracle.run(bounds[k], bounds[k + 1]);
    for (std::size_t i = bounds[k]; i < bounds[k + 1]; ++i)
      expected.add(set, i, block, oracle.has_vertex(i));
  }
  return expected;
}

}  // namespace psf::tests
