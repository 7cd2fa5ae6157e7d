// [hash]: averages over the cells of a jittered grid instead of balls; no search.
#pragma once

#include <memory>

#include "filter/problem.h"

namespace psf::filter {

// An engine after Binder, Fricke and Keller, Massively Parallel Path Space Filtering, 2019;
// README.md says what differs. `scale`: [radius] without f_i, > 0. `first_path`: path number of
// record 0. `problem` must outlive the engine. Its average() cannot count refusals, because there
// is no ball.
[[nodiscard]] std::unique_ptr<Engine> make_hash(EngineKind kind, const Problem& problem,
                                                double scale, std::uint64_t first_path);

}  // namespace psf::filter
