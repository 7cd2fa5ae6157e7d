// The floor's records are such that every pair must be tested, and what passes is what should.
#include "filter/engine/floor.h"

#include "catch.h"
#include "engine_case.h"
#include "filter/engine/instruction_sets.h"

namespace psf {
namespace {

using filter::engine::Floor;

TEST_CASE("On the floor each instruction set passes the same pairs, some of all") {
  for (const unsigned bits : {0u, 7u, 1u, 2u, 4u, 8u, 16u, 32u, 64u}) {
    Floor floor(tests::terms_of(bits));
    const std::uint64_t passed = floor.run(1);
    INFO("terms " << bits);
    CHECK(passed > Floor::kPairs / 500);
    CHECK(passed < Floor::kPairs * 9 / 10);
    for (const std::string& set : filter::engine::instruction_sets()) {
      const filter::engine::InstructionSetLimit limit(set);
      CHECK(floor.run(3) == 3 * passed);
    }
  }
}

TEST_CASE("On the floor each term refuses some of what the others pass") {
  const std::uint64_t chi = Floor(tests::terms_of(0)).run(1);
  for (unsigned k = 0; k < 7; ++k) {
    INFO("term " << k);
    CHECK(Floor(tests::terms_of(1u << k)).run(1) < chi);
  }
}

}  // namespace
}  // namespace psf
