// The interface of estimators: a method computes c_bar of a block. What an estimator needs, takes
// and refuses is its row of parameters/estimators.h.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "filter/estimate.h"
#include "filter/fireflies.h"
#include "filter/problem.h"

namespace psf::filter {

struct MethodInput {
  const Records& records;  // lengths in a unit in which their squares are floats
  std::span<const float> radius;
  const Block& block;
  const Parameters& parameters;  // valid, and the records have the channels
  std::optional<Fireflies>* fireflies =
      nullptr;  // where to put those that are found; null: nowhere
};

// What estimate() returns; radii are in the unit of the input. The result is the same for any
// number of threads. Throws Error{interrupted} on ^C.
using Method = Estimates (*)(const MethodInput&);

// What differs between the methods that apply an engine; they are called in this order. Arrays are
// indexed by record number.
struct EngineSteps {
  // A_j of the sources; null: [average].
  std::vector<float> (*areas)(const Records&, const Roles&, const Block&) = nullptr;
  // Radii of its own, from a problem with those given; null: those given. `values`: what is
  // averaged.
  std::vector<float> (*radii)(const Problem&, std::span<const Rgb> values,
                              const Parameters&) = nullptr;
  std::unique_ptr<Engine> (*engine)(const Problem&, const Block&, const Parameters&);
};

// Finds the roles, and applies an engine to the contributions, as often as `iterations` says.
[[nodiscard]] Estimates apply_engine(const MethodInput& input, const EngineSteps& steps);

// The engine for balls that parameters.engine names.
[[nodiscard]] std::unique_ptr<Engine> ball_engine(const Problem& problem, const Block& block,
                                                  const Parameters& parameters);

// For a block without any source: its queries are in no picture.
void leave_out_queries(std::span<Role> roles, Statistics& statistics);

}  // namespace psf::filter
