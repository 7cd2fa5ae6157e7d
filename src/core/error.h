// The only exception type of the project, and the exit codes of its kinds.
#pragma once

#include <stdexcept>
#include <string>

namespace psf {

// What kind of thing went wrong; the values are the exit codes of every tool.
enum class ErrorCode : int {
  comparison = 1,    // a comparison or verification failed
  usage = 2,         // a mistake in the command line
  bad_input = 3,     // a file that is malformed, damaged or lacks something
  io = 4,            // the operating system refused: missing file, full disk, permissions
  limit = 5,         // a limit of memory, size or time
  interrupted = 130  // ^C
};

// The one exception of the project, for bad input and failed I/O. The message is one line that
// names the file, the place in it and the remedy: "room.json: /materials/2/roughness: expected a
// number in [0, 1]". Written Error{io} where only the kind matters.
class [[gnu::visibility("default")]] Error : public std::runtime_error {
 public:
  // `message`: one line, which what() returns.
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  // The kind, and the exit code of a tool that ends with it.
  [[nodiscard]] ErrorCode code() const noexcept {
    return code_;
  }

 private:
  ErrorCode code_;
};

}  // namespace psf
