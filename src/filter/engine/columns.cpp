#include "filter/engine/columns.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

#include "filter/weights.h"

namespace psf::filter::engine {

ColumnPlan::ColumnPlan(const WeightTerms& terms) {
  const auto take = [this](bool wanted, std::optional<std::size_t>& first, std::size_t columns) {
    if (!wanted) return;
    first = count;
    count += columns;
  };
  // The tangent plane is that of the query, which has the columns of a source.
  take(terms.normal || terms.plane || terms.gloss, normal, 3);
  take(terms.reflectance.has_value(), reflectance, 3);
  take(terms.visibility, visibility, 1);
  take(terms.hit_distance.has_value(), hit_distance, 1);
  take(terms.direction || terms.gloss, direction, 3);
  take(terms.material, material, 1);
  take(terms.gloss.has_value(), lobe_width, 1);
  assert(count <= kMaxColumns);
}

void ColumnPlan::gather(const Records& records, std::span<const std::uint32_t> chosen,
                        float* out) const {
  std::array<std::uint32_t, kWidth> i;
  for (std::size_t k = 0; k < kWidth; ++k) i[k] = chosen[std::min(k, chosen.size() - 1)];
  const auto put3 = [&](std::size_t column, const auto& values) {
    float* x = out + column * kWidth;
    for (std::size_t k = 0; k < kWidth; ++k) {
      x[k] = values[i[k]].x;
      x[kWidth + k] = values[i[k]].y;
      x[2 * kWidth + k] = values[i[k]].z;
    }
  };
  const auto put_bits = [&](std::size_t column, std::span<const std::uint32_t> values) {
    for (std::size_t k = 0; k < kWidth; ++k) {
      out[column * kWidth + k] = std::bit_cast<float>(values[i[k]]);
    }
  };
  put3(0, records.position);
  if (normal) put3(*normal, records.normal);
  if (reflectance) put3(*reflectance, records.reflectance);
  if (visibility) put_bits(*visibility, records.visibility);
  if (hit_distance) {
    for (std::size_t k = 0; k < kWidth; ++k) {
      out[*hit_distance * kWidth + k] = records.hit_distance[i[k]];
    }
  }
  if (direction) put3(*direction, records.direction);
  if (material) put_bits(*material, records.material);
  if (lobe_width) {
    for (std::size_t k = 0; k < kWidth; ++k) {
      out[*lobe_width * kWidth + k] = filter::lobe_width(records.roughness[i[k]]);
    }
  }
}

}  // namespace psf::filter::engine
