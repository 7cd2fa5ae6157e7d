#include "filter/estimators/hash.h"

#include <vector>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "filter/estimators/hash_cells.h"
#include "filter/orphans.h"
#include "filter/radius.h"
#include "filter/sum.h"

namespace psf::filter {
namespace {

constexpr std::size_t kKeyGrain = 1024, kCellGrain = 256;
// An orphan looks into cells up to 2^8 times as long; then it is no question of place any more.
constexpr int kCoarsest = 8;

// Records and the cells that they share; `members` of cells are places in `records`.
struct Grid {
  std::vector<std::uint32_t> records;
  Cells cells;
};

class HashEngine final : public Engine {
 public:
  HashEngine(EngineKind kind, const Problem& problem, double scale, std::uint64_t first_path)
      : p_(problem),
        kind_(kind),
        keys_(problem.records, problem.weights.terms(), scale, first_path) {
    for (const std::uint32_t i : p_.roles.queries) {
      (has_cell(i) ? grid_.records : alone_).push_back(i);
    }
    fill(grid_, 0);
  }

  void apply(std::span<const Averaged> all, BallFit, bool, std::span<std::uint32_t> neighbors,
             Statistics& statistics) override {
    share(grid_, all, neighbors);
    std::vector<std::uint32_t> orphans;
    for (const std::uint32_t i : alone_) {
      neighbors[i] = p_.roles.of[i] == Role::source ? 1 : 0;
      for (const auto& [values, out] : all) out[i] = values[i];
    }
    for (const std::uint32_t i : p_.roles.queries) {
      statistics.add_query(neighbors[i]);
      if (neighbors[i] == 0) orphans.push_back(i);
    }
    if (!orphans.empty()) adopt_all(std::move(orphans), all, statistics);
  }

 private:
  // As chi has it: where r_i^2 is 0, in float, a record is alone.
  [[nodiscard]] bool has_cell(std::uint32_t i) const { return p_.radius[i] * p_.radius[i] > 0; }

  void fill(Grid& grid, int coarser) const {
    core::throw_if_interrupted("no picture was written");
    std::vector<CellKey> keys(grid.records.size());
    core::parallel_for(keys.size(), kKeyGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        keys[k] = keys_(grid.records[k], p_.radius[grid.records[k]], coarser);
      }
    });
    grid.cells = group_equal(keys);
  }

  // out[i] and neighbors[i] of everyone in the grid; neighbors[i] is 0, and out[i] as it was, where
  // the cell has no source.
  void share(const Grid& grid, std::span<const Averaged> all,
             std::span<std::uint32_t> neighbors) const {
    core::parallel_for(grid.cells.count(), kCellGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t cell = begin; cell < end; ++cell) {
        for (const Averaged& one : all) share(grid, grid.cells[cell], one, neighbors);
      }
    });
  }

  // The same of one cell and one value.
  void share(const Grid& grid, std::span<const std::uint32_t> cell, const Averaged& one,
             std::span<std::uint32_t> neighbors) const {
    Sum sum;
    std::uint32_t count = 0;
    for (const std::uint32_t member : cell) {
      const std::uint32_t j = grid.records[member];
      if (p_.roles.of[j] != Role::source) continue;
      sum.add(one.values[j], 1);
      ++count;
    }
    for (const std::uint32_t member : cell) {
      const std::uint32_t i = grid.records[member];
      neighbors[i] = count;
      if (count > 0) one.out[i] = sum.over(count);
    }
  }

  // Coarser cells first, then, for those who have nobody to pass the weights, the rule of balls.
  void adopt_all(std::vector<std::uint32_t> orphans, std::span<const Averaged> all,
                 Statistics& statistics) const {
    std::vector<std::vector<Rgb>> means(all.size(), std::vector<Rgb>(p_.records.size()));
    std::vector<Averaged> found;
    for (std::size_t k = 0; k < all.size(); ++k) found.push_back({all[k].values, means[k]});
    std::vector<std::uint32_t> counts(p_.records.size());
    for (int coarser = 1; coarser <= kCoarsest && !orphans.empty(); ++coarser) {
      Grid grid;
      for (const std::uint32_t j : p_.roles.sources) {
        if (has_cell(j)) grid.records.push_back(j);
      }
      for (const std::uint32_t i : orphans) {
        if (has_cell(i)) grid.records.push_back(i);
      }
      fill(grid, coarser);
      share(grid, found, counts);
      std::vector<std::uint32_t> rest;
      for (const std::uint32_t i : orphans) {
        if (has_cell(i) && counts[i] > 0) {
          for (std::size_t k = 0; k < all.size(); ++k) all[k].out[i] = means[k][i];
          ++statistics.orphans;
        } else {
          rest.push_back(i);
        }
      }
      orphans = std::move(rest);
    }
    adopt_nearest(orphans, all, statistics);
  }

  void adopt_nearest(std::span<const std::uint32_t> orphans, std::span<const Averaged> all,
                     Statistics& statistics) const {
    if (orphans.empty()) return;
    std::vector<Vec3> positions;
    for (const std::uint32_t j : p_.roles.sources) positions.push_back(p_.records.position[j]);
    const auto search = search::make_search(search_of(kind_), positions);
    std::vector<Statistics> parts(core::range_count(orphans.size(), kCellGrain));
    core::parallel_for(orphans.size(), kCellGrain, [&](std::size_t begin, std::size_t end) {
      core::throw_if_interrupted("no picture was written");
      for (const std::uint32_t i : orphans.subspan(begin, end - begin)) {
        average_adopted(adopt(*search, p_, i), i, all, parts[begin / kCellGrain]);
      }
    });
    for (const Statistics& part : parts) statistics += part;
  }

  const Problem& p_;
  EngineKind kind_;
  KeyMaker keys_;
  Grid grid_;                         // the cells of all queries
  std::vector<std::uint32_t> alone_;  // queries with r_i = 0
};

std::unique_ptr<Engine> hash_engine(const Problem& problem, const Block& block,
                                    const Parameters& parameters) {
  // Where r0 is 0 no record has a cell, and any scale does.
  const double scale = radius_scale(parameters.radius, block.n);
  return std::make_unique<HashEngine>(parameters.engine, problem, scale > 0 ? scale : 1,
                                      block.first_path);
}

}  // namespace

Estimates hash(const MethodInput& input) {
  return apply_engine(input, {.engine = hash_engine});
}

}  // namespace psf::filter
