// The example renderer: its dump is whole, resumes exactly, and the filter takes its error down.
#include <cstdlib>

#include "c_file.h"
#include "catch.h"
#include "formats/check/check.h"
#include "formats/read/reader.h"
#include "tools/command.h"

using namespace psf;
using psf::tests::Outcome;
using psf::tests::run;

namespace {

Outcome run_well(const std::string& command) {
  Outcome outcome = run(command);
  INFO(command << "\n" << outcome.err);
  REQUIRE(outcome.code == 0);
  return outcome;
}

double relative_mse(const std::string& picture, const std::string& reference) {
  const Outcome outcome = run_well("psf compare " + picture + " " + reference);
  REQUIRE(outcome.out.rfind("relMSE ", 0) == 0);
  return std::atof(outcome.out.c_str() + 7);
}

}  // namespace

TEST_CASE("the sphere's dump is whole, and the same when it was stopped and resumed") {
  const test::Scratch scratch;
  const std::string once = scratch.path("once.pvb"), twice = scratch.path("twice.pvb");
  run_well("psf_sphere " + once + " 5 40");
  run_well("psf_sphere " + twice + " 2 40");
  run_well("psf_sphere " + twice + " 3 40");
  for (const std::string& path : {once, twice}) {
    const formats::CheckResult report = formats::check(path);
    CHECK(report.faults.empty());
    CHECK(report.closed);
    CHECK(report.passes == 5);
    CHECK(report.records == 5 * 40 * 30);
  }
  const formats::Reader a(once), b(twice);
  for (std::size_t k = 0; k < a.head().channels.size(); ++k) {
    CHECK(test::read_all(a, k) == test::read_all(b, k));
  }
  CHECK(run("psf_sphere " + once + " 1 41").err.find("metadata is not the same") !=
        std::string::npos);
  CHECK(run("psf_sphere " + scratch.path("none/x.pvb")).code == 4);
}

TEST_CASE(
    "psf filter takes the sphere's dump as it is, and at most a quarter of the error is left") {
  const test::Scratch scratch;
  const std::string many = scratch.path("many.pvb"), few = scratch.path("few.pvb");
  run_well("psf_sphere " + many + " 400 96");
  run_well("psf_sphere " + few + " 4 96");
  run_well("psf filter " + many + " --quiet --r0 0 -o " + scratch.path("many.exr"));
  run_well("psf filter " + few + " --quiet --r0 0 -o " + scratch.path("few.exr"));
  run_well("psf filter " + few + " --quiet -o " + scratch.path("filtered.exr"));
  const double before = relative_mse(scratch.path("few.exr"), scratch.path("many.exr"));
  const double after = relative_mse(scratch.path("filtered.exr"), scratch.path("many.exr"));
  CAPTURE(before, after);
  CHECK(after < before / 4);
}
