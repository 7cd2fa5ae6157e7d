// [hash]: the cell of a record, as a key that holds everything that is compared.
#pragma once

#include <cstdint>

#include "filter/records.h"
#include "filter/weights.h"

namespace psf::filter {

// Records whose keys are equal byte by byte share a cell. The values are whole numbers, except
// where a threshold of 0 asks for equal values, and 0 where a term is off.
struct CellKey {
  float place[3] = {}, level = 0;
  float normal[3] = {}, reflectance[3] = {}, direction[3] = {}, hit_distance = 0;
  float lobe_normal[3] = {}, lobe_direction[3] = {}, lobe_level = 0, unused = 0;
  std::uint32_t visibility = 0, material = 0;

  // Returns a number below, equal to or above 0, like memcmp().
  [[nodiscard]] int compare(const CellKey& other) const;
  [[nodiscard]] std::uint64_t hash() const;
};
static_assert(sizeof(CellKey) == 96, "bytes of a key are compared, so there are no holes in it");

// Quantizes vectors to cubes, such that any two vectors in a cube are at most `reach` apart. The
// side of a cube is 1 over a whole number, and 0 and 1, which walls have as components, lie in the
// middle of a cube, where neither rounding nor jitter splits them. Reach 0: only equal vectors
// share a cube.
class Cubes {
 public:
  // `jittered`: vectors are moved by up to half a cube each way, so the cubes are half as long.
  Cubes(double reach, bool jittered);
  // Writes the numbers of the cube of `v`. `bits`: random bits for the jitter.
  void write(const Vec3& v, std::uint64_t bits, float (&out)[3]) const;

 private:
  double per_unit_;
  bool jittered_;
};

// Makes keys such that any two records with equal keys pass every term of `terms`, except `plane`,
// since a plane belongs to one record and not to a cell.
class KeyMaker {
 public:
  // `scale`: world units, > 0; cells of all sizes differ by powers of two.
  // `first_path`: path number of record 0; a path's jitter depends on its number alone.
  // Reads `position`, `normal` (not of volumes) and the channels of `terms`.
  KeyMaker(const Records& records, const WeightTerms& terms, double scale,
           std::uint64_t first_path);

  // The key of record i with r_i > 0, in cells whose side is multiplied by 2^coarser.
  [[nodiscard]] CellKey operator()(std::uint32_t i, float r_i, int coarser) const;

  // The side of a cell in world units: 2^coarser times the root of pi r^2, where r is r_i with r_i
  // / scale rounded to a power of two.
  [[nodiscard]] double side(double r_i, int coarser) const;

 private:
  void place(std::uint32_t i, double r_i, int coarser, CellKey& key) const;
  [[nodiscard]] float hit_distance(float h) const;
  void write_lobe(std::uint32_t i, std::uint64_t bits, CellKey& key) const;

  Records r_;
  WeightTerms on_;
  double scale_;
  std::uint64_t first_path_;
  Cubes normals_, reflectances_, directions_;
  double hit_step_;
};

}  // namespace psf::filter
