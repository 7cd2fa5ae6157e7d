// What the programs say of themselves.
#include <string>

#include "catch.h"
#include "command.h"

TEST_CASE("a program names its version, commit, compiler, instructions and libraries") {
  for (const std::string program : {"psf", "psf-render", "psf-bench"}) {
    const psf::tests::Outcome outcome = psf::tests::run(program + " --version");
    INFO(outcome.out);
    CHECK(outcome.code == 0);
    CHECK(outcome.err.empty());
    CHECK(outcome.out.starts_with(program + " 0."));
    for (const std::string name : {"commit", "compiler", "libraries"}) {
      const std::size_t at = outcome.out.find("\n" + name + " ");
      REQUIRE(at != std::string::npos);
      const std::string line = outcome.out.substr(at + 1, outcome.out.find('\n', at + 1) - at - 1);
      CHECK(line.size() > name.size() + 8);
      CHECK(line.find("  ,") == std::string::npos);
    }
    CHECK((outcome.out.find("\ninstructions ") != std::string::npos) == (program != "psf-render"));
    CHECK(outcome.out.find("OpenEXR 3") != std::string::npos);
    CHECK(outcome.out.find(" ,") == std::string::npos);  // no library without its version
  }
}
