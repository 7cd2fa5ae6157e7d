// An explained pixel as a point cloud to look at.
#pragma once

#include <cstdint>
#include <iterator>
#include <string>

#include "explain/attribution.h"
#include "filter/parameters/terms.h"

namespace psf::explain {

// Writes a binary little-endian point cloud of all vertices of the explanation, each once:
// float x y z, nx ny nz (0 where the file has no normals), uchar red green blue, and
//   float scalar_kind         0: of a path of the pixel, 1: averaged, 2: in a ball but refused, 3: a
//                             firefly that is not averaged but gives
//   float scalar_share        what the vertex adds to the pixel's luminance, as a fraction of it
//   float scalar_excess       the part of this share beyond what the pixel's own paths give
//   float scalar_paths        number of the pixel's paths that average the vertex, or to which it
//                             gives
//   float scalar_distance     to the nearest of the pixel's vertices whose ball holds this vertex
//   float scalar_refused_by   sum of 2^k over the terms k that refuse it in every ball, or 0;
//                             k = 8: one of the two is in a volume
//   float scalar_x, scalar_y  pixel of the vertex
//   double scalar_record      number of the vertex in the dump, for which float is too short
// and where fireflies are not kept
//   float scalar_kept         what is averaged of the vertex, from 0 to 1: below 1 it is a firefly
//   float scalar_given        the part of scalar_share that the vertex gives as a firefly
// Lengths are in world units.
// Colours: the pixel's own vertices are red; averaged ones, and fireflies, are dark grey to white with
// the root of their share; refused ones have the colour in kTermColours of the first term that refuses them.
// Returns the number of points. Throws Error{io}.
std::uint64_t write_ply(const ExplainResult& explanation, const Attribution& whence,
                        const std::string& path);

// The colour of each term of filter::kTermNames: blue, orange, sky blue, green, yellow, vermilion,
// purple, black. Colour-blind people can tell these apart too (Okabe and Ito). The last is that of
// what keeps volumes and surfaces apart: brown.
inline constexpr std::uint8_t kTermColours[][3] = {{0, 114, 178},   {230, 159, 0},  {86, 180, 233},
                                                   {0, 158, 115},   {240, 228, 66}, {213, 94, 0},
                                                   {204, 121, 167}, {0, 0, 0},      {120, 72, 32}};
static_assert(std::size(kTermColours) == filter::kTermCount + 1);

}  // namespace psf::explain
