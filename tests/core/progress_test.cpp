// Times as people write them.
#include "core/progress.h"

#include "catch.h"

TEST_CASE("seconds are shown as minutes and, from an hour on, hours") {
  using psf::core::format_seconds;
  CHECK(format_seconds(0) == "0:00");
  CHECK(format_seconds(59.4) == "0:59");
  CHECK(format_seconds(59.6) == "1:00");
  CHECK(format_seconds(3599) == "59:59");
  CHECK(format_seconds(3661) == "1:01:01");
  CHECK(format_seconds(-1) == "0:00");
}
