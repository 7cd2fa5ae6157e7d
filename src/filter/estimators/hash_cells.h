// Brings records with equal keys together in cells.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/estimators/hash_key.h"

namespace psf::filter {

// The members of cell k are members[first[k]] to members[first[k + 1] - 1]: numbers of keys,
// ascending.
struct Cells {
  std::vector<std::uint32_t> members, first;
  [[nodiscard]] std::size_t count() const { return first.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t k) const {
    return std::span(members).subspan(first[k], first[k + 1] - first[k]);
  }
};

// Groups equal keys. Hashes bring keys together, but the keys themselves are compared, so two cells
// never mix even where their hashes are equal. Time is proportional to the number of keys. The
// result is the same for any number of threads. `hash_mask`: the bits of the hash in use; only
// tests use fewer than all.
[[nodiscard]] Cells group_equal(std::span<const CellKey> keys, std::uint64_t hash_mask = ~0ull);

}  // namespace psf::filter
