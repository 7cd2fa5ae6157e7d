// The header compiles without a word at the strictest settings, as C99 and as C++, alone and with
// its code, by every compiler that is installed.
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "catch.h"
#include "tools/command.h"

using psf::tests::run;
using psf::tests::TempFolder;

namespace {

const std::string kFormats = PSF_SOURCE_DIR "/formats";

const std::string kGnu =
    " -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wcast-qual -Wcast-align"
    " -Wundef -Wdouble-promotion -Wformat=2 -Wnull-dereference";
const std::string kGnuC = kGnu + " -Wstrict-prototypes -Wmissing-prototypes";
const std::string kGnuCxx = kGnu + " -Wold-style-cast -Wuseless-cast";
// All that clang has, but for what contradicts the languages themselves:
//   padded                       says where a struct has padding, which is no fault
//   declaration-after-statement  C89
//   c++98-compat(-pedantic)      C++98
//   unsafe-buffer-usage          (clang 16) forbids pointer arithmetic, which is C
//   unknown-warning-option       not every version knows every name
const std::string kClang =
    " -Weverything -Wno-unknown-warning-option -Wno-padded -Wno-unsafe-buffer-usage";
const std::string kClangC = kClang + " -Wno-declaration-after-statement";
const std::string kClangCxx = kClang + " -Wno-c++98-compat -Wno-c++98-compat-pedantic";

bool is_installed(const std::string& compiler) {
  return run("command -v " + compiler).code == 0;
}

void compile(const std::string& compiler, const std::string& options) {
  const TempFolder folder;
  std::ofstream(folder / "alone") << "#include \"pvb.h\"\n"
                                     "extern const pvb_channel used[2];\n"
                                     "const pvb_channel used[2] = {PVB_POSITION, PVB_FLAGS};\n";
  std::ofstream(folder / "code") << "#define PVB_IMPLEMENTATION\n#include \"pvb.h\"\n"
                                    "#include \"pvb.h\"\n";
  for (const std::string source : {"alone", "code"}) {
    const std::string command =
        compiler + options + " -Werror -O2 -I" + kFormats + " -c -o /dev/null " + folder / source;
    const auto outcome = run(command);
    INFO(command << "\n" << outcome.err);
    CHECK(outcome.code == 0);
    CHECK(outcome.err.empty());
  }
}

}  // namespace

TEST_CASE("as C99 and C++ by gcc, without a word") {
  compile("gcc", " -x c -std=c99 -pedantic" + kGnuC);
  compile("g++", " -x c++ -std=c++11" + kGnuCxx);
  compile("g++", " -x c++ -std=c++20" + kGnuCxx);
}

TEST_CASE("as C99 and C++ by clang, without a word", "[.][long]") {
  if (!is_installed("clang") || !is_installed("clang++")) SKIP("clang is not installed");
  compile("clang", " -x c -std=c99" + kClangC);
  compile("clang++", " -x c++ -std=c++11" + kClangCxx);
  compile("clang++", " -x c++ -std=c++20" + kClangCxx);
}

TEST_CASE("the example compiles as its first lines say, in under a hundred lines") {
  const TempFolder folder;
  const auto outcome = run("cd " + kFormats + " && cc -O2 sphere.c -lm -o " + folder / "sphere");
  CHECK(outcome.code == 0);
  CHECK(outcome.err.empty());
  CHECK(run(folder / "sphere" + " " + folder / "out.pvb" + " 1 16").code == 0);
  std::ifstream in(kFormats + "/sphere.c");
  std::size_t lines = 0;
  for (std::string line; std::getline(in, line);) ++lines;
  CHECK(lines < 100);
}
