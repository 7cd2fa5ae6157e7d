#include "search/search.h"

#include "search/brute_force.h"
#include "search/index.h"

namespace psf::search {

std::unique_ptr<Search> make_search(Kind kind, std::span<const Vec3> points) {
  if (kind == Kind::brute) return std::make_unique<BruteForce>(points);
  return std::make_unique<Index>(points);
}

}  // namespace psf::search
