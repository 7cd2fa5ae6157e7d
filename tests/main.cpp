// The main function of every test program.
#if __has_include(<catch2/catch_session.hpp>)
#include <catch2/catch_session.hpp>
#else
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#endif

#include <sys/stat.h>

int main(int argc, char** argv) {
  umask(022);  // programs are tried as other users too, who must be able to read what is made here
  return Catch::Session().run(argc, argv);
}
