#include "filter/lists.h"

#include <vector>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "filter/engine/near.h"
#include "search/search.h"

namespace psf::filter {
namespace {

constexpr std::size_t kListGrain = 64;  // centres a range

// A search a centre.
class PlainLists final : public Lists {
 public:
  PlainLists(EngineKind kind, const Problem& problem, std::span<const std::uint32_t> centers,
             std::span<const float> reach)
      : p_(problem), centers_(centers), reach_(reach) {
    std::vector<Vec3> positions;
    for (const std::uint32_t i : p_.roles.queries) positions.push_back(p_.records.position[i]);
    search_ = search::make_search(search_of(kind), positions);
  }

  void each(const Visit& visit) const override {
    core::parallel_for(centers_.size(), kListGrain, [&](std::size_t begin, std::size_t end) {
      core::throw_if_interrupted("no picture was written");
      std::vector<search::Neighbor> found;
      std::vector<std::uint32_t> near;
      for (std::size_t k = begin; k < end; ++k) {
        search_->within(p_.records.position[centers_[k]], reach_[k] * reach_[k], found);
        near.clear();
        for (const search::Neighbor& one : found) {
          const std::uint32_t i = p_.roles.queries[one.index];
          if (i != centers_[k] && p_.alike(i, centers_[k])) near.push_back(i);
        }
        visit(k, near);
      }
    });
  }

 private:
  const Problem& p_;
  std::span<const std::uint32_t> centers_;
  std::span<const float> reach_;
  std::unique_ptr<search::Search> search_;
};

}  // namespace

std::unique_ptr<Lists> make_lists(EngineKind kind, const Problem& problem,
                                  std::span<const std::uint32_t> centers,
                                  std::span<const float> reach) {
  if (kind == EngineKind::flann) {
    if (auto lists = engine::make_lists(problem, centers, reach)) return lists;
  }
  return std::make_unique<PlainLists>(kind, problem, centers, reach);
}

}  // namespace psf::filter
