#include "filter/parameters/estimators.h"

#include "core/vec.h"
#include "filter/parameters/parameters.h"

namespace psf::filter {
namespace {

constexpr Refusal kHashRefusals[] = {
    {[](const Parameters& p) { return p.weights.plane.has_value(); },
     "`plane`: a plane is one record's, a cell of `estimator hash` has none; give `plane off`"},
    {[](const Parameters& p) { return p.iterations != 1; },
     "`iterations`: what a cell of `estimator hash` shares does not change when it is averaged "
     "again; give 1"},
    {[](const Parameters& p) { return p.count_refusals; },
     "`refusals`: counts what is in balls, and `estimator hash` has none"},
};

constexpr Refusal kControlRefusals[] = {
    {[](const Parameters& p) { return p.iterations != 1; },
     "`iterations`: a half of `estimator control` has averages of the other's sources alone; give "
     "1"},
    {[](const Parameters& p) { return p.count_refusals; },
     "`refusals`: the balls of `estimator control` hold halves; count with `estimator average`"},
};

constexpr Refusal kDensityRefusals[] = {
    {[](const Parameters& p) { return p.demodulate; },
     "`demodulate`: photons of `estimator density` are no quotient of a reflectance, they are "
     "multiplied by it; leave it out"},
    {[](const Parameters& p) { return p.iterations != 1; },
     "`iterations`: photons of `estimator density` cannot be filtered again; give 1"},
    {[](const Parameters& p) { return p.sources != 1; },
     "`sources`: the sources of `estimator density` are photons, of which it takes all; give 1/1"},
};

constexpr EstimatorInfo kEstimators[kEstimatorCount] = {
    {.name = "average", .meaning = "", .fits = true, .shares_traversal = true},
    {.name = "disk",
     .meaning = "photon mapping's",
     .channels = {"normal", "direction"},
     .is_over_area = true,
     .shares_traversal = true,
     .bytes = sizeof(float)},  // areas
    {.name = "hash",
     .meaning = "cells of a jittered grid",
     .channels = {"normal"},
     .refusals = kHashRefusals,
     .is_of_ball = false,
     // A key, its hash, two entries to sort, and places in cells, twice for orphans.
     .bytes = 96 + 64 + sizeof(Rgb),
     .has_tree = false},
    {.name = "control",
     .meaning = "halves as control variates, unbiased",
     .refusals = kControlRefusals,
     .is_of_ball = false,
     .of_the_whole = "beta",
     // Values, moments, the means of both, counts, and the roles of a half, whose tree is smaller.
     .bytes = 4 * sizeof(Rgb) + 3 * sizeof(float) + 1},
    {.name = "adaptive",
     .meaning = "balls whose contributions agree",
     .fits = true,
     .least_share = 1.0 / 16,
     .of_the_whole = "radii",
     // Radii in float and in double, and luminances. Its tree for rings is freed before the tree
     // for averages is built.
     .bytes = sizeof(float) + sizeof(double) + sizeof(Rgb)},
    {.name = "density",
     .meaning = "photon mapping's, of photons",
     .channels = {"normal", "reflectance"},
     .refusals = kDensityRefusals,
     .terms = bit(Term::normal) | bit(Term::plane) | bit(Term::material),
     .is_of_photons = true,
     .is_of_ball = false,
     .shares_traversal = true,
     // The records' part of the set that they and the photons make, whose tree is the photons'.
     .bytes = 3 * sizeof(Vec3) + sizeof(Rgb) + sizeof(float) + sizeof(std::uint32_t) + 2,
     .has_tree = false},
};

}  // namespace

std::span<const EstimatorInfo> estimators() {
  return kEstimators;
}

}  // namespace psf::filter
