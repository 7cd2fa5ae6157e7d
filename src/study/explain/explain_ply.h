// An explained pixel as a point cloud to look at.
#pragma once

#include <cstdint>
#include <string>

#include "study/explain/explain_whence.h"

namespace psf::study {

// A binary little-endian point cloud of the vertices that play a part, each once: float x y z,
// nx ny nz (0 where the file has no normals), uchar red green blue, and
//   float scalar_kind         0 of a path of the pixel, 1 averaged, 2 in a ball but refused
//   float scalar_share        of the pixel's luminance, as a fraction of its value
//   float scalar_excess       the same, beyond what the pixel's own paths say
//   float scalar_paths        how many of the pixel's paths average it
//   float scalar_distance     to the nearest of the pixel's vertices whose ball holds it
//   float scalar_refused_by   sum of 2^k over terms k that refuse it in every ball, or 0
//   float scalar_x, scalar_y  its pixel
//   double scalar_record      its number in the dump, which float does not hold
// Lengths are in world units.
// Colours: the pixel's own vertices red; averaged ones from dark grey to white with the root of
// their share; refused ones by the first term that refuses them: kTermColours.
// Returns the number of points. Throws Error{io}.
std::uint64_t write_ply(const Explanation& explanation, const Whence& whence,
                        const std::string& path);

// By term of filter::kTermNames: blue, orange, sky blue, green, yellow, vermilion, purple, black;
// distinct to colour-blind eyes, too (Okabe and Ito).
inline constexpr std::uint8_t kTermColours[8][3] = {{0, 114, 178},   {230, 159, 0},  {86, 180, 233},
                                                    {0, 158, 115},   {240, 228, 66}, {213, 94, 0},
                                                    {204, 121, 167}, {0, 0, 0}};

}  // namespace psf::study
