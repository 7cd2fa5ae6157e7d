// Blocks partition the chosen passes, and b^m blocks lie where floor(i / b^m) b^m puts them.
#include "filter/blocks.h"

#include "catch.h"
#include "core/error.h"
#include "filter/parameters/text.h"

namespace psf {
namespace {

filter::BlockSize block_of(const std::string& text) {
  filter::Parameters parameters;
  filter::set_parameter(parameters, "block", text);
  return parameters.block;
}

using filter::Blocks;
using filter::PathRange;

const std::vector<std::uint64_t> kBounds = {0, 100, 200, 250, 250, 1000};  // 5 passes, one empty

std::vector<PathRange> blocks(const std::string& size, std::size_t first, std::size_t last) {
  const Blocks all(block_of(size), kBounds, first, last);
  std::vector<PathRange> list;
  for (std::uint64_t k = 0; k < all.count(); ++k) list.push_back(all[k]);
  return list;
}

TEST_CASE("Blocks hold every chosen path once, in order") {
  for (const char* size : {"2^0", "2^6", "2^7", "3^4", "10^2", "10^3", "2^63", "3^40", "3^63",
                           "1pass", "2passes", "99passes", "all"}) {
    for (std::size_t first = 0; first < 5; ++first) {
      for (std::size_t last = first; last <= 5; ++last) {
        INFO(size << " " << first << ":" << last);
        std::uint64_t path = kBounds[first];
        for (const PathRange& block : blocks(size, first, last)) {
          REQUIRE(block.first == path);
          path = block.last;
        }
        CHECK(path == kBounds[last]);
      }
    }
  }
}

TEST_CASE("Blocks of b^m are cut where they lie, blocks of passes counted from the first") {
  CHECK(blocks("2^7", 1, 3) == std::vector<PathRange>{{100, 128}, {128, 250}});
  CHECK(blocks("10^2", 0, 3) == std::vector<PathRange>{{0, 100}, {100, 200}, {200, 250}});
  CHECK(blocks("2passes", 1, 5) == std::vector<PathRange>{{100, 250}, {250, 1000}});
  CHECK(blocks("2passes", 0, 3) == std::vector<PathRange>{{0, 200}, {200, 250}});
  CHECK(blocks("all", 1, 3) == std::vector<PathRange>{{100, 250}});
}

TEST_CASE("Blocks past 2^32 paths are where they should be, and too large ones refused") {
  const std::uint64_t many = std::uint64_t{5} << 32;
  const Blocks blocks(block_of("2^20"), {0, many, many + 3}, 0, 2);
  CHECK(blocks.count() == (many >> 20) + 1);
  CHECK(blocks[blocks.count() - 1] == PathRange{many, many + 3});
  CHECK(blocks[4096] == PathRange{std::uint64_t{1} << 32, (std::uint64_t{1} << 32) + (1 << 20)});
  for (const char* size : {"all", "1pass", "2^31", "3^63"}) {
    CHECK_THROWS_AS(Blocks(block_of(size), {0, many}, 0, 1), Error);
  }
}

}  // namespace
}  // namespace psf
