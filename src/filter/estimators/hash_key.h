// [hash]: the cell that a record falls into, as a key of everything that is compared.
#pragma once

#include <cstdint>

#include "filter/records.h"
#include "filter/weights.h"

namespace psf::filter {

// Equal keys, byte by byte, are one cell. Whole numbers, except where a threshold of 0 asks for
// equal values; 0 where a term is off.
struct CellKey {
  float place[3] = {}, level = 0;
  float normal[3] = {}, reflectance[3] = {}, direction[3] = {}, hit_distance = 0;
  float lobe_normal[3] = {}, lobe_direction[3] = {}, lobe_level = 0, unused = 0;
  std::uint32_t visibility = 0, material = 0;

  // Below, equal or above 0, as memcmp().
  [[nodiscard]] int compare(const CellKey& other) const;
  [[nodiscard]] std::uint64_t hash() const;
};
static_assert(sizeof(CellKey) == 96, "bytes of a key are compared, so there are no holes in it");

// Vectors counted in cubes, such that any two of one cube are at most `reach` apart. A whole number
// of cubes goes into 1, and 0 and 1, the components of walls, lie in the middle of a cube, where
// neither rounding nor jitter splits them. Reach 0: only equal vectors share a cube.
class Cubes {
 public:
  // `jittered`: vectors are moved by up to half a cube each way, so cubes are half as long.
  Cubes(double reach, bool jittered);
  // `bits`: random, of the jitter.
  void write(const Vec3& v, std::uint64_t bits, float (&out)[3]) const;

 private:
  double per_unit_;
  bool jittered_;
};

// Makes keys such that any two records with one key pass every term of `terms`; `plane` is not
// among them, since a plane belongs to one record and not to a cell.
class KeyMaker {
 public:
  // `scale`: world units, > 0; the sides of cells are its multiples by powers of two.
  // `first_path`: path number of record 0; a path's jitter depends on its number alone.
  // Reads `position`, `normal` and the channels of `terms`.
  KeyMaker(const Records& records, const WeightTerms& terms, double scale,
           std::uint64_t first_path);

  // Of record i with r_i > 0, in a cell of 2^coarser times the side.
  [[nodiscard]] CellKey operator()(std::uint32_t i, float r_i, int coarser) const;

  // Of a cell, world units: the root of pi r^2, where r is r_i but that r_i / scale is rounded to a
  // power of two.
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
