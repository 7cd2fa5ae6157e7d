#include "filter/estimators/hash_key.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "filter/estimators/scramble.h"

namespace psf::filter {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMargin = 1e-6;  // relative, for the rounding of the terms in float
constexpr double kRootPi = 1.7724538509055160;

// The whole number below x; never -0, which has other bytes than 0.
float whole(double x) {
  return static_cast<float>(std::floor(x)) + 0.0f;
}

// Unit vectors n and n' with n . n' = t differ by so much.
double chord(const std::optional<float>& t) {
  return std::sqrt(2 - 2 * double{t.value_or(0)});
}

// Two unit vectors across n and each other.
void tangents(const Vec3& n, Vec3& u, Vec3& v) {
  u = std::abs(n.x) > std::abs(n.z) ? Vec3(-n.y, n.x, 0) : Vec3(0, -n.z, n.y);
  const float length = std::sqrt(length_sq(u));
  u = length > 0 ? u / length : Vec3(1, 0, 0);
  v = cross(n, u);
}

// log2(x), rounded, by exact operations.
int rounded_log2(double x) {
  return std::ilogb(x * std::sqrt(2));
}

// Lengths with a quotient in [1 - t, 1] share a step of their logarithms.
double step_of(const std::optional<float>& t) {
  if (!t || *t >= 1) return kInfinity;
  return -std::log1p(-double{*t}) * (1 - kMargin);
}

}  // namespace

int CellKey::compare(const CellKey& other) const {
  return std::memcmp(this, &other, sizeof(CellKey));
}

std::uint64_t CellKey::hash() const {
  std::uint64_t words[sizeof(CellKey) / sizeof(std::uint64_t)], bits = 0;
  std::memcpy(words, this, sizeof(CellKey));
  for (const std::uint64_t word : words) bits = scramble(bits ^ word);
  return bits;
}

Cubes::Cubes(double reach, bool jittered)
    : per_unit_(std::ceil((jittered ? 2 : 1) * std::sqrt(3) / reach * (1 + kMargin))),
      jittered_(jittered) {}

void Cubes::write(const Vec3& v, std::uint64_t bits, float (&out)[3]) const {
  constexpr double kMost = 1e9;  // finer than floats
  for (int axis = 0; axis < 3; ++axis) {
    const double shift = jittered_ ? to_unit(bits << (21 * axis)) : 0.5;
    out[axis] = per_unit_ < kMost ? whole(double{v[axis]} * per_unit_ + shift) : v[axis] + 0.0f;
  }
}

KeyMaker::KeyMaker(const Records& records, const WeightTerms& terms, double scale,
                   std::uint64_t first_path)
    : r_(records),
      on_(terms),
      scale_(scale),
      first_path_(first_path),
      normals_(chord(terms.normal), true),
      reflectances_(double{terms.reflectance.value_or(1)}, false),
      directions_(chord(terms.direction), true),
      hit_step_(step_of(terms.hit_distance)) {}

CellKey KeyMaker::operator()(std::uint32_t i, float r_i, int coarser) const {
  CellKey key;
  place(i, double{r_i}, coarser, key);
  const std::uint64_t bits = scramble(~(first_path_ + i));
  if (on_.normal) normals_.write(r_.normal[i], bits, key.normal);
  if (on_.reflectance) reflectances_.write(r_.reflectance[i], 0, key.reflectance);
  if (on_.direction) directions_.write(r_.direction[i], scramble(bits), key.direction);
  if (on_.gloss) write_lobe(i, scramble(~bits), key);
  if (on_.hit_distance) key.hit_distance = hit_distance(r_.hit_distance[i]);
  if (on_.visibility) key.visibility = r_.visibility[i];
  if (on_.material) key.material = r_.material[i];
  return key;
}

double KeyMaker::side(double r_i, int coarser) const {
  return std::ldexp(kRootPi * scale_, rounded_log2(r_i / scale_) + coarser);
}

void KeyMaker::place(std::uint32_t i, double r_i, int coarser, CellKey& key) const {
  if (std::isinf(r_i)) {
    key.level = std::numeric_limits<float>::max();
    return;
  }
  // Walls are often at whole numbers; were these the borders of cells, rounding would tear them.
  constexpr double kOffset[3] = {0.3819, 0.6180, 0.2361};
  const double cell = side(r_i, coarser);
  key.level = static_cast<float>(std::ilogb(cell));
  const std::uint64_t bits = scramble(first_path_ + i);
  const double a = to_unit(bits) - 0.5, b = to_unit(bits << 32) - 0.5;
  Vec3 u(1, 0, 0), v(0, 1, 0), w(0, 0, 0);
  double c = 0;
  if (r_.in_volume(i)) {  // there is no surface to stay on
    w.z = 1;
    c = to_unit(scramble(bits)) - 0.5;
  } else {
    tangents(r_.normal[i], u, v);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double jitter = a * double{u[axis]} + b * double{v[axis]} + c * double{w[axis]};
    key.place[axis] = whole(double{r_.position[i][axis]} / cell + jitter + kOffset[axis]);
  }
}

// Widths are rounded down to a power of two, and half of the square of what it allows is each of
// the normal's and the direction's.
void KeyMaker::write_lobe(std::uint32_t i, std::uint64_t bits, CellKey& key) const {
  const double width = double{lobe_width(r_.roughness[i])};
  if (std::isinf(width)) {
    key.lobe_level = std::numeric_limits<float>::max();
    return;
  }
  const double least = width > 0 ? std::ldexp(1, std::ilogb(width)) : 0;
  const double reach = double{*on_.gloss} * least / std::sqrt(2);
  key.lobe_level = static_cast<float>(least);
  Cubes(reach, true).write(r_.normal[i], bits, key.lobe_normal);
  Cubes(reach / std::sqrt(double{kDirectionWeight}), true)
      .write(r_.direction[i], scramble(bits), key.lobe_direction);
}

float KeyMaker::hit_distance(float h) const {
  if (std::isinf(h)) return h;  // a miss
  if (!(h > 0)) return -std::numeric_limits<float>::infinity();
  if (std::isinf(hit_step_)) return 0;
  return hit_step_ > 0 ? whole(std::log(double{h}) / hit_step_) : h;
}

}  // namespace psf::filter
