// Runs a program of ours as a shell would, and keeps what it said.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <iterator>
#include <string>

#include "read_text.h"
#include "temp_folder.h"

namespace psf::tests {

struct Outcome {
  int code = -1;  // exit code, 128 + signal where it was killed
  std::string out, err;
};

// `command`: "psf info x.pvb"; the first word is looked up among the programs just built.
inline Outcome run(const std::string& command) {
  const TempFolder folder;
  const std::string line = "PATH=" PSF_BINARY_DIR ":\"$PATH\" " + command + " >" + folder / "out" +
                           " 2>" + folder / "err" + " </dev/null";
  const int status = std::system(line.c_str());
  Outcome outcome;
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = read_text(folder / "out");
  outcome.err = read_text(folder / "err");
  return outcome;
}

}  // namespace psf::tests
