#include "filter/problem.h"

#include <algorithm>
#include <cmath>

#include "filter/engine/engine.h"
#include "filter/plain.h"

namespace psf::filter {
namespace {

// Products and sums of products of values up to this are finite floats, which the bounds of the
// fast engine rely on.
constexpr float kLargest = 1e18f;

template <class Triple>
bool all_moderate(std::span<const Triple> values, const Roles& roles) {
  return std::all_of(roles.queries.begin(), roles.queries.end(), [&](std::uint32_t i) {
    const Triple& v = values[i];
    return std::max(std::max(std::abs(v.x), std::abs(v.y)), std::abs(v.z)) <= kLargest;
  });
}

bool is_moderate(const Problem& problem) {
  const Records& r = problem.records;
  const WeightTerms& on = problem.weights.terms();
  return all_moderate(r.position, problem.roles) &&
         (!(on.normal || on.plane) || all_moderate(r.normal, problem.roles)) &&
         (!on.reflectance || all_moderate(r.reflectance, problem.roles)) &&
         (!on.direction || all_moderate(r.direction, problem.roles));
}

}  // namespace

std::unique_ptr<Engine> make_engine(search::Kind kind, const Problem& problem) {
  if (kind == search::Kind::flann && is_moderate(problem)) return engine::make(problem);
  return make_plain(kind, problem);
}

}  // namespace psf::filter
