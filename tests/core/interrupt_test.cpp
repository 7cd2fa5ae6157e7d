// ^C sets a flag that long work looks at.
#include "core/interrupt.h"

#include <csignal>

#include "catch.h"
#include "core/error.h"

TEST_CASE("the first interrupt is noted and becomes exit code 130 where work can end") {
  psf::core::watch_interrupts();
  CHECK_NOTHROW(psf::core::throw_if_interrupted("nothing is lost"));
  std::raise(SIGINT);
  REQUIRE(psf::core::interrupted());
  try {
    psf::core::throw_if_interrupted("nothing is lost");
    FAIL("no error");
  } catch (const psf::Error& error) {
    CHECK(static_cast<int>(error.code()) == 130);
    CHECK(std::string(error.what()) == "interrupted: nothing is lost");
  }
}
