// The filter written a second time, from the equations of the design alone: double precision, naive
// loops, and nothing of the filter but its parameters.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "filter/parameters/parameters.h"
#include "record_set.h"

namespace psf::tests {

using Triple = std::array<double, 3>;

inline Triple triple(const Vec3& v) {
  return {double{v.x}, double{v.y}, double{v.z}};
}
inline double inner(const Triple& a, const Triple& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Triple minus(const Triple& a, const Triple& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

struct OracleResult {
  std::vector<bool> has_average;
  std::vector<Triple> c_bar;
  std::vector<std::size_t> neighbors;  // 0: orphan
  std::vector<double> radius;
  std::size_t orphans = 0, unmatched = 0, candidates = 0;
  std::array<std::size_t, 8> refused{};
};

class Oracle {
 public:
  // `n` of [radius]; `first_path`: number of record 0 in its dump.
  Oracle(const RecordSet& set, const filter::Parameters& parameters,
         const std::vector<filter::CameraView>& cameras, double n, std::uint64_t first_path,
         double samples_per_pixel)
      : s_(set),
        p_(parameters),
        cameras_(cameras),
        n_(n),
        first_path_(first_path),
        samples_per_pixel_(samples_per_pixel) {}

  // The result for the records [first, last), which are one block.
  [[nodiscard]] OracleResult run(std::size_t first, std::size_t last) const {
    const std::size_t count = s_.size();
    OracleResult r;
    r.has_average.assign(count, false);
    r.c_bar.assign(count, Triple{});
    r.neighbors.assign(count, 0);
    r.radius.assign(count, 0);
    std::vector<Triple> value(count);
    std::vector<std::size_t> sources;
    for (std::size_t j = first; j < last; ++j) {
      if (!is_source(j)) continue;
      sources.push_back(j);
      value[j] = triple(s_.contribution[j]);
      for (std::size_t k = 0; k < 3 && p_.demodulate; ++k) {
        const double rho = triple(s_.reflectance[j])[k];
        if (rho > 0) value[j][k] /= rho;
      }
    }
    for (std::uint32_t iteration = 0; iteration < p_.iterations; ++iteration) {
      std::vector<Triple> next(count);
      for (std::size_t i = first; i < last; ++i) {
        if (!has_vertex(i) || sources.empty()) continue;
        r.has_average[i] = true;
        r.radius[i] = radius(i);
        next[i] = average(i, sources, value, iteration == 0 ? &r : nullptr);
      }
      value = next;
    }
    for (std::size_t i = first; i < last; ++i) {
      r.c_bar[i] = value[i];
      for (std::size_t k = 0; k < 3 && p_.demodulate; ++k) {
        const double rho = triple(s_.reflectance[i])[k];
        if (rho > 0) r.c_bar[i][k] *= rho;
      }
    }
    return r;
  }

  [[nodiscard]] bool has_vertex(std::size_t i) const { return s_.flags[i] % 2 == 1; }
  [[nodiscard]] bool is_source(std::size_t i) const {
    if (s_.flags[i] != 3) return false;
    if (p_.sources == 1) return true;
    std::uint64_t pixels = 0;
    for (const auto& camera : cameras_) pixels += std::uint64_t{camera.width} * camera.height;
    const double plastic = 1.32471795724474602596, golden = 1.61803398874989484820;
    const double x = s_.pixel[i] % cameras_[s_.camera[i]].width,
                 y = s_.pixel[i] / cameras_[s_.camera[i]].width;
    const auto pass = static_cast<double>((first_path_ + i) / pixels);
    const double v = x / plastic + y / (plastic * plastic) + pass / golden;
    return v - std::floor(v) < 1.0 / p_.sources;
  }
  [[nodiscard]] double radius(std::size_t i) const {
    const double f = p_.radius.basis == filter::RadiusBasis::world ? 1
                     : p_.radius.basis == filter::RadiusBasis::distance
                         ? double{s_.distance[i]}
                         : double{s_.distance[i]} * cameras_[s_.camera[i]].angle_per_pixel;
    return p_.radius.r0 * f / std::pow(n_, p_.radius.delta / 2);
  }

 private:
  // By term, in the order of the design's table.
  [[nodiscard]] std::array<bool, 8> refusals(std::size_t i, std::size_t j) const {
    const filter::WeightTerms& w = p_.weights;
    const Triple d_rho = minus(triple(s_.reflectance[i]), triple(s_.reflectance[j]));
    const double h_i = double{s_.hit_distance[i]}, h_j = double{s_.hit_distance[j]};
    const bool both_missed = std::isinf(h_i) && std::isinf(h_j);
    const bool one_missed = std::isinf(h_i) != std::isinf(h_j);
    const double off_plane =
        inner(minus(triple(s_.position[j]), triple(s_.position[i])), triple(s_.normal[i]));
    return {w.normal && inner(triple(s_.normal[i]), triple(s_.normal[j])) < double{*w.normal},
            w.reflectance && std::sqrt(inner(d_rho, d_rho)) > double{*w.reflectance},
            w.visibility && s_.visibility[i] != s_.visibility[j],
            w.hit_distance && !both_missed &&
                (one_missed || std::abs(h_i - h_j) / std::max(h_i, h_j) > double{*w.hit_distance}),
            w.plane && std::abs(off_plane) > double{*w.plane} * radius(i),
            w.direction &&
                inner(triple(s_.direction[i]), triple(s_.direction[j])) < double{*w.direction},
            w.material && s_.material[i] != s_.material[j],
            w.gloss && turns_out_of_lobe(i, j)};
  }
  [[nodiscard]] bool turns_out_of_lobe(std::size_t i, std::size_t j) const {
    const double roughness = double{s_.roughness[i]};
    const Triple n = minus(triple(s_.normal[i]), triple(s_.normal[j]));
    const Triple omega = minus(triple(s_.direction[i]), triple(s_.direction[j]));
    return roughness < 1 && std::sqrt(inner(n, n) + 100 * inner(omega, omega)) >
                                double{*p_.weights.gloss} * roughness * roughness;
  }
  [[nodiscard]] bool passes(std::size_t i, std::size_t j) const {
    const auto by = refusals(i, j);
    return std::none_of(by.begin(), by.end(), [](bool refused) { return refused; });
  }
  [[nodiscard]] double distance_sq(std::size_t i, std::size_t j) const {
    const Triple d = minus(triple(s_.position[j]), triple(s_.position[i]));
    return inner(d, d);
  }

  [[nodiscard]] Triple average(std::size_t i, const std::vector<std::size_t>& sources,
                               const std::vector<Triple>& value, OracleResult* r) const {
    Triple sum{};
    std::size_t neighbors = 0;
    double total = 0;
    const bool disk = p_.estimator == filter::Estimator::disk && radius(i) > 0;
    for (const std::size_t j : sources) {
      if (j != i && distance_sq(i, j) >= radius(i) * radius(i)) continue;
      if (r != nullptr) count(i, j, *r);
      if (j != i && !passes(i, j)) continue;
      ++neighbors;
      double weight = 1;
      if (disk) {
        const double side = cameras_[0].angle_per_pixel * double{s_.distance[j]};
        const double cosine = std::abs(inner(triple(s_.normal[j]), triple(s_.direction[j])));
        weight = side * side / std::max(cosine, 0.01) / samples_per_pixel_;
      }
      total += weight;
      for (std::size_t k = 0; k < 3; ++k) sum[k] += weight * value[j][k];
    }
    if (neighbors == 0) return adopt(i, sources, value, r);
    if (disk) total = 3.14159265358979323846 * radius(i) * radius(i);
    for (double& component : sum) component /= total;
    if (r != nullptr) r->neighbors[i] = neighbors;
    return sum;
  }
  void count(std::size_t i, std::size_t j, OracleResult& r) const {
    ++r.candidates;
    const auto by = refusals(i, j);
    for (std::size_t k = 0; k < 8 && j != i; ++k) r.refused[k] += by[k] ? 1u : 0u;
  }
  // The 4 nearest that pass, ties by the lower record; the nearest of all where none does.
  [[nodiscard]] Triple adopt(std::size_t i, const std::vector<std::size_t>& sources,
                             const std::vector<Triple>& value, OracleResult* r) const {
    std::vector<std::pair<double, std::size_t>> near;
    for (const std::size_t j : sources) near.emplace_back(distance_sq(i, j), j);
    std::sort(near.begin(), near.end());
    std::vector<std::size_t> taken;
    for (std::size_t k = 0; k < near.size() && taken.size() < 4; ++k) {
      if (passes(i, near[k].second)) taken.push_back(near[k].second);
    }
    if (r != nullptr) {
      ++r->orphans;
      r->unmatched += taken.empty() ? 1u : 0u;
    }
    if (taken.empty()) taken.push_back(near.front().second);
    Triple mean{};
    for (const std::size_t j : taken) {
      for (std::size_t k = 0; k < 3; ++k)
        mean[k] += value[j][k] / static_cast<double>(taken.size());
    }
    return mean;
  }

  const RecordSet& s_;
  const filter::Parameters& p_;
  const std::vector<filter::CameraView>& cameras_;
  double n_;
  std::uint64_t first_path_;
  double samples_per_pixel_;
};

}  // namespace psf::tests
