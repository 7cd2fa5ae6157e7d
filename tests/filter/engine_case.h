// Records to filter with every engine, and how the results must agree.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "filter/estimate.h"
#include "record_set.h"

namespace psf::tests {

inline constexpr std::array kEngines = {filter::EngineKind::flann, filter::EngineKind::plain,
                                        filter::EngineKind::brute};

struct EngineCase {
  RecordSet set;
  std::vector<float> radius;  // by record
  filter::Parameters parameters;
  std::vector<filter::CameraView> cameras = {{16, 10, 0.04}};

  // The records of random_records(), but that contributions are whole numbers which tell records
  // apart: their sums in double are exact in any order, so engines that average the same sources
  // agree to the last bit, and others hardly.
  EngineCase(std::size_t count, std::uint32_t seed, double share_unshaded = 0)
      : set(random_records(count, seed, share_unshaded, {{16, 10, 0.04}})), radius(count, 0.2f) {
    for (std::size_t j = 0; j < count; ++j) {
      const auto number = static_cast<std::uint32_t>(j + 1);
      set.contribution[j] = Rgb(static_cast<float>(number % 8191 + 1),
                                static_cast<float>(number * 2654435761u >> 20), 1);
    }
    parameters.weights = filter::WeightTerms::none();
    parameters.count_refusals = true;
  }

  [[nodiscard]] filter::Estimates filtered(filter::EngineKind kind) const {
    filter::Parameters chosen = parameters;
    chosen.engine = kind;
    return filter::estimate(set.view(), radius, {0, 1, 1.5, cameras}, chosen);
  }
};

// The same with the contributions cut into two layers.
inline filter::Estimates filtered_in_two(const EngineCase& c, filter::EngineKind kind) {
  std::array<std::vector<Rgb>, 2> parts;
  for (std::size_t i = 0; i < c.set.size(); ++i) {
    const float share = static_cast<float>(i % 4) / 3;
    parts[0].push_back(c.set.contribution[i] * share);
    parts[1].push_back(c.set.contribution[i] * (1 - share));
  }
  const std::array<filter::Layer, 2> layers = {{{parts[0], {}}, {parts[1], {}}}};
  filter::Parameters chosen = c.parameters;
  chosen.engine = kind;
  filter::Records records = c.set.view();
  records.layers = layers;
  return filter::estimate(records, c.radius, {0, 1, 1.5, c.cameras}, chosen);
}

// What there is to say of the first difference; nothing where there is none. `tolerance`: of
// averages, relative; 0 asks for the same bytes.
inline std::string difference(const filter::Estimates& a, const filter::Estimates& b,
                              float tolerance = 0) {
  for (std::size_t i = 0; i < a.c_bar.size(); ++i) {
    if (a.roles[i] != b.roles[i]) return fmt::format("role of record {}", i);
    if (a.neighbors[i] != b.neighbors[i]) {
      return fmt::format("record {} has {} and {} neighbours", i, a.neighbors[i], b.neighbors[i]);
    }
    for (int k = 0; k < 3; ++k) {
      const float x = a.c_bar[i][k], y = b.c_bar[i][k];
      const bool same = tolerance == 0 ? std::memcmp(&x, &y, sizeof x) == 0
                                       : std::abs(x - y) <= tolerance * std::abs(y);
      if (!same) return fmt::format("record {}: {} and {}", i, x, y);
    }
  }
  const filter::Statistics &s = a.statistics, &t = b.statistics;
  if (s.candidates != t.candidates) {
    return fmt::format("{} and {} candidates", s.candidates, t.candidates);
  }
  if (s.refused != t.refused) return "refusals";
  if (s.orphans != t.orphans || s.orphans_unmatched != t.orphans_unmatched) return "orphans";
  if (s.accepted != t.accepted) return "pairs accepted";
  if (s.min_neighbors != t.min_neighbors || s.max_neighbors != t.max_neighbors) return "extremes";
  return "";
}

}  // namespace psf::tests
