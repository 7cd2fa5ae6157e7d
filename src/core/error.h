// The only exception type of the project, and the exit codes of its kinds.
#pragma once

#include <stdexcept>
#include <string>

namespace psf {

// Exit codes of every tool.
enum class ErrorCode : int {
  comparison = 1,    // a comparison or verification failed
  usage = 2,         // a mistake in the command line
  bad_input = 3,     // a file that is malformed, damaged or lacks something
  io = 4,            // the operating system refused: missing file, full disk, permissions
  limit = 5,         // a limit of memory, size or time
  interrupted = 130  // ^C
};

// Thrown for bad input and failed I/O, caught once, in main. The message is one line that names the
// file, the place in it and the remedy: "room.json: /materials/2/roughness: expected a number in
// [0, 1]".
// Visible outside libpsf, where it is caught.
class [[gnu::visibility("default")]] Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  [[nodiscard]] ErrorCode code() const noexcept {
    return code_;
  }

 private:
  ErrorCode code_;
};

}  // namespace psf
