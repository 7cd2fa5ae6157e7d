// Records with equal keys, brought together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/estimators/hash_key.h"

namespace psf::filter {

// Cell k has members [first[k], first[k + 1]), numbers of keys, ascending.
struct Cells {
  std::vector<std::uint32_t> members, first;
  [[nodiscard]] std::size_t count() const { return first.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t k) const {
    return std::span(members).subspan(first[k], first[k + 1] - first[k]);
  }
};

// Hashes bring the keys of a cell together; whether they are equal the keys themselves say, so two
// cells never mix, even where their hashes are the same. Time grows with the number of keys. The
// same for any number of threads. `hash_mask`: bits of the hash in use, all but in tests.
[[nodiscard]] Cells group_equal(std::span<const CellKey> keys, std::uint64_t hash_mask = ~0ull);

}  // namespace psf::filter
