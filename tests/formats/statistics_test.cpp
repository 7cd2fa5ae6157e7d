// Statistics and sizes against values that are known.
#include "formats/read/statistics.h"

#include <limits>

#include "catch.h"
#include "file_bytes.h"
#include "formats/write/writer.h"

using namespace psf;
using namespace psf::formats;

TEST_CASE("statistics count what is not finite and leave it out") {
  const test::Scratch scratch;
  Head head;
  head.channels = {{"v", Type::f32, 2}, {"flags", Type::u8, 1}};
  head.chunk_capacity = 3;
  const float infinity = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> v = {1,   nan,       -3,  nan, infinity, nan, 5,
                                nan, -infinity, nan, nan, nan,      9,   nan};
  const std::vector<std::uint8_t> flags = {0, 1, 2, 3, 0, 0, 255};
  {
    Writer writer(scratch.path("s.pvb"), head, {Codec::raw, false, {}});
    const std::array<const void*, 2> columns = {v.data(), flags.data()};
    writer.append(7, columns);
    writer.commit();
  }
  const Reader reader(scratch.path("s.pvb"));
  const auto of = channel_statistics(reader.table(0), 0);
  REQUIRE(of.size() == 2);
  CHECK(of[0].finite == 4);
  CHECK(of[0].non_finite == 3);
  CHECK(of[0].min == -3);
  CHECK(of[0].max == 9);
  CHECK(of[0].mean() == 3);
  CHECK(of[1].finite == 0);
  CHECK(of[1].non_finite == 7);
  const auto of_flags = channel_statistics(reader.table(0), 1);
  CHECK(of_flags[0].max == 255);
  CHECK(of_flags[0].mean() == Approx(261.0 / 7));
  const auto sizes = channel_sizes(reader.table(0));
  CHECK(sizes[0].raw == 56);
  CHECK(sizes[0].stored == 56);
  CHECK(sizes[0].raw_columns == 3);
  CHECK(sizes[1].raw == 7);
}
