// [average] for one block: c_bar of every record.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/parameters.h"
#include "filter/records.h"
#include "filter/roles.h"
#include "filter/statistics.h"

namespace psf::filter {

// By record number.
struct Average {
  std::vector<Role>
      roles;  // c_bar is there for `query` and `source`; `left_out` is no part of the picture
  std::vector<Rgb> c_bar;                // 0 elsewhere
  std::vector<std::uint32_t> neighbors;  // sources averaged; 0 for an orphan
  Statistics statistics;
  std::vector<float> radius = {};  // that [adaptive] chose; empty: those that were given
};

// `radius`: r_i in world units, finite or infinite, >= 0 (radii() of radius.h). The channels that
// parameters use must be there (else Error{bad_input}), parameters valid, cameras of the records in
// block.cameras. A record whose ball holds itself alone keeps c_i bit for bit. Deterministic for
// any number of threads. Throws Error{interrupted} on ^C, Error{usage} for the estimator `disk`
// with several cameras.
[[nodiscard]] Average average(const Records& records, std::span<const float> radius,
                              const Block& block, const Parameters& parameters);

}  // namespace psf::filter
