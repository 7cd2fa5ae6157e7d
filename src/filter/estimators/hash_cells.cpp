#include "filter/estimators/hash_cells.h"

#include <algorithm>
#include <array>

#include "core/parallel.h"

namespace psf::filter {
namespace {

constexpr std::size_t kEntryGrain = 4096;  // keys a range
// Parts of the hashes' range, each sorted for itself and small enough for the cache.
constexpr std::size_t kPartBits = 8, kParts = std::size_t{1} << kPartBits;

struct Entry {
  std::uint64_t hash;
  std::uint32_t key;
};

std::size_t part_of(std::uint64_t hash) {
  return hash >> (64 - kPartBits);
}

// Entries by part, ascending within; part p begins at begins[p].
std::vector<Entry> deal_out(std::span<const CellKey> keys, std::uint64_t mask,
                            std::array<std::size_t, kParts + 1>& begins) {
  std::vector<std::uint64_t> hashes(keys.size());
  std::vector<std::array<std::size_t, kParts>> places(core::range_count(keys.size(), kEntryGrain));
  core::parallel_for(keys.size(), kEntryGrain, [&](std::size_t begin, std::size_t end) {
    auto& counts = places[begin / kEntryGrain];
    counts.fill(0);
    for (std::size_t k = begin; k < end; ++k) {
      hashes[k] = keys[k].hash() & mask;
      ++counts[part_of(hashes[k])];
    }
  });
  std::size_t place = 0;
  for (std::size_t part = 0; part < kParts; ++part) {
    begins[part] = place;
    for (auto& range : places) {
      const std::size_t count = range[part];
      range[part] = place;
      place += count;
    }
  }
  begins[kParts] = place;
  std::vector<Entry> entries(keys.size());
  core::parallel_for(keys.size(), kEntryGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      entries[places[begin / kEntryGrain][part_of(hashes[k])]++] = {hashes[k],
                                                                    static_cast<std::uint32_t>(k)};
    }
  });
  return entries;
}

bool by_hash(const Entry& a, const Entry& b) {
  return a.hash != b.hash ? a.hash < b.hash : a.key < b.key;
}

}  // namespace

Cells group_equal(std::span<const CellKey> keys, std::uint64_t hash_mask) {
  std::array<std::size_t, kParts + 1> begins;
  std::vector<Entry> entries = deal_out(keys, hash_mask, begins);
  const auto equal = [&](const Entry& a, const Entry& b) {
    return a.hash == b.hash && keys[a.key].compare(keys[b.key]) == 0;
  };
  const auto by_key = [&](const Entry& a, const Entry& b) {
    const int order = keys[a.key].compare(keys[b.key]);
    return order != 0 ? order < 0 : a.key < b.key;
  };
  std::vector<std::vector<std::uint32_t>> firsts(kParts);
  core::parallel_for(kParts, 1, [&](std::size_t part, std::size_t) {
    const auto begin = entries.begin() + static_cast<std::ptrdiff_t>(begins[part]);
    const auto end = entries.begin() + static_cast<std::ptrdiff_t>(begins[part + 1]);
    std::sort(begin, end, by_hash);
    for (auto run = begin; run != end;) {
      const auto same_hash = [&](const Entry& e) { return e.hash != run->hash; };
      const auto stop = std::find_if(run, end, same_hash);
      const bool mixed = !std::all_of(run, stop, [&](const Entry& e) { return equal(*run, e); });
      if (mixed) std::sort(run, stop, by_key);
      for (auto at = run; at != stop; ++at) {
        if (at != run && equal(*(at - 1), *at)) continue;
        firsts[part].push_back(static_cast<std::uint32_t>(at - entries.begin()));
      }
      run = stop;
    }
  });
  Cells cells;
  cells.members.reserve(entries.size());
  for (const Entry& entry : entries) cells.members.push_back(entry.key);
  for (const auto& some : firsts) cells.first.insert(cells.first.end(), some.begin(), some.end());
  cells.first.push_back(static_cast<std::uint32_t>(entries.size()));
  return cells;
}

}  // namespace psf::filter
