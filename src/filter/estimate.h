// Runs an estimator on one block: c_bar of every record.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/parameters/parameters.h"
#include "filter/records.h"
#include "filter/roles.h"
#include "filter/statistics.h"

namespace psf::filter {

class Fireflies;

// The result of estimate(); every array is indexed by record number.
struct Estimates {
  // Records that are `query` or `source` have c_bar; `left_out` is in no picture.
  std::vector<Role> roles;
  std::vector<Rgb> c_bar;                // 0 for the other records
  std::vector<std::uint32_t> neighbors;  // number of sources averaged; 0 for an orphan
  Statistics statistics;
  // By layer of the records: c_bar of its contributions; empty where it has none.
  std::vector<std::vector<Rgb>> layers = {};
  std::vector<float> radius = {};  // the radii that the estimator chose; empty: those given
  std::vector<Rgb> given = {};     // what of c_bar [fireflies] have spread; empty: nothing
};

// Filters one block with parameters.estimator. `radius`: r_i in world units, finite or infinite, >=
// 0 (radii() of radius.h). `parameters` must be valid, and block.cameras must hold the cameras of
// the records. A record whose ball holds itself alone keeps c_i bit for bit. The result is the same
// for any number of threads. Throws Error{bad_input} where a channel that `parameters` use is
// missing, Error{usage} for the estimator `disk` with several cameras, Error{interrupted} on ^C.
// Adds to `fireflies`, where it is given, those that were found: apart for surfaces and volumes.
[[nodiscard]] Estimates estimate(const Records& records, std::span<const float> radius,
                                 const Block& block, const Parameters& parameters,
                                 std::vector<Fireflies>* fireflies = nullptr);

}  // namespace psf::filter
