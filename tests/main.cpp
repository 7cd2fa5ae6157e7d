// The main function of every test program.
#if __has_include(<catch2/catch_session.hpp>)
#include <catch2/catch_session.hpp>
#else
#define CATCH_CONFIG_RUNNER
#include "catch.h"
#define PSF_CATCH_2
#endif

#include <sys/stat.h>

#ifdef PSF_CATCH_2
namespace {

constexpr int kAllSkipped = 4;  // as version 3 has it

int ended_cases = 0;

struct CountCases : Catch::TestEventListenerBase {
  using TestEventListenerBase::TestEventListenerBase;
  void testCaseEnded(const Catch::TestCaseStats&) override { ++ended_cases; }
};
CATCH_REGISTER_LISTENER(CountCases)

}  // namespace
#endif

int main(int argc, char** argv) {
  umask(022);  // programs are tried as other users too, who must be able to read what is made here
  const int code = Catch::Session().run(argc, argv);
#ifdef PSF_CATCH_2
  if (code == 0 && ended_cases > 0 && psf::tests::skipped_cases() == ended_cases) {
    return kAllSkipped;
  }
#endif
  return code;
}
