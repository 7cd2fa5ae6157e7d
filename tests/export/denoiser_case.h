// Records with all that an export has to bear, as a dump; and what their paths are, by pixel.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "../filter/record_set.h"
#include "../runs/write_dump.h"
#include "../temp_folder.h"
#include "run/dump.h"

namespace psf::tests {

struct Sample {
  bool in_picture = false;
  std::array<float, 3> color{}, albedo{}, normal{};
  float depth = 0;
};

// By camera and pixel, in path order.
using Samples = std::vector<std::vector<std::vector<Sample>>>;

struct DenoiserCase {
  std::vector<filter::CameraView> cameras = {{5, 4, 0.01}, {3, 2, 0.01}};
  RecordSet set{0};
  DumpOptions options;

  // One path in ten has no vertex, one in `shade_rate` is shaded; passes of different lengths, so
  // that pixels have different numbers of samples.
  explicit DenoiserCase(std::uint32_t shade_rate = 1, std::size_t most_cameras = 2) {
    cameras.resize(most_cameras);
    options.cameras = cameras;
    options.passes = {26, 52, 26, 130, 26, 33};
    options.shade_rate = shade_rate;
    std::size_t count = 0;
    for (const std::size_t pass : options.passes) count += pass;
    set = random_records(count, 5, 1 - 1.0 / shade_rate, cameras);
    for (std::size_t i = 0; i < count; ++i) {
      // A path without vertex of a dump with a shade rate says by this flag whether it was shaded.
      if (set.flags[i] == 0 && shade_rate > 1 && i % shade_rate == 0) {
        set.flags[i] = filter::kShaded;
      }
      if (i % 7 == 0) set.unfiltered[i].x = 40;  // beyond all bins
      if (i % 11 == 0) set.unfiltered[i] = Rgb(-2, 0, 0.5f);
    }
  }

  // Makes values of some records not finite. Returns how many are left out, and how many overflow.
  std::array<std::size_t, 2> spoil() {
    set.contribution[3].y = kNan;
    set.flags[3] = filter::kHasVertex | filter::kShaded;
    set.unfiltered[20] = Rgb(kInfinity, 0, 0);
    set.flags[41] = filter::kHasVertex | filter::kShaded;
    set.normal[41].z = kNan;
    set.flags[60] = filter::kHasVertex | filter::kShaded;
    set.throughput[60] = set.contribution[60] = Rgb(1e30f, 1, 1);
    set.flags[80] = 0;
    set.normal[80] = Vec3(kNan, kNan, kNan);  // no vertex: nobody looks at it
    return {3, 1};
  }

  void write(const std::string& path) const { write_dump(path, set, options); }

  // The paths [first, last) that are not spoiled.
  [[nodiscard]] Samples samples(std::size_t first, std::size_t last) const {
    Samples all;
    for (const filter::CameraView& camera : cameras) {
      all.emplace_back(std::size_t{camera.width} * camera.height);
    }
    for (std::size_t i = first; i < last; ++i) {
      const bool vertex = (set.flags[i] & filter::kHasVertex) != 0;
      const bool shaded = (set.flags[i] & filter::kShaded) != 0;
      Sample sample;
      sample.in_picture = shaded || (!vertex && options.shade_rate == 1);
      bool finite = true;
      for (int c = 0; c < 3; ++c) {
        const auto k = static_cast<std::size_t>(c);
        sample.color[k] = set.unfiltered[i][c];
        if (vertex && shaded) {
          const float light = set.throughput[i][c] * set.contribution[i][c];
          sample.color[k] = set.unfiltered[i][c] + light;
        }
        if (vertex) {
          sample.albedo[k] = set.reflectance[i][c];
          sample.normal[k] = set.normal[i][c];
          sample.depth = set.distance[i];
        }
        finite = finite && std::isfinite(sample.color[k]) && std::isfinite(sample.albedo[k]) &&
                 std::isfinite(sample.normal[k]);
      }
      if (finite) all[set.camera[i]][set.pixel[i]].push_back(sample);
    }
    return all;
  }
};

}  // namespace psf::tests
