#include "core/standard_streams.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include "core/error.h"

namespace psf::core {

void open_standard_streams() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) != -1 || errno != EBADF) continue;
    // The lowest that is free is what open() gives. The wrong way round: reading and writing fail.
    static_cast<void>(::open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY));
  }
}

void flush_standard_output() {
  errno = 0;
  const bool failed_before = std::ferror(stdout) != 0;
  if (std::fflush(stdout) == 0 && !failed_before) return;
  // What failed while it was printed is tried no more: a byte more tells why.
  const bool told = errno != 0 || ::write(STDOUT_FILENO, "\n", 1) != 1;
  throw Error(ErrorCode::io, std::string("standard output: ") +
                                 (told && errno != 0 ? std::strerror(errno) : "cannot write"));
}

void say(std::string_view text) noexcept {
  try {
    std::string line;
    for (const char c : text) {
      const auto byte = static_cast<unsigned char>(c);
      if (c == '\n') {
        line += "\\n";
      } else if (byte < ' ' || byte == 0x7F) {
        line += fmt::format("\\x{:02x}", byte);
      } else {
        line += c;
      }
    }
    line += '\n';
    static_cast<void>(std::fwrite(line.data(), 1, line.size(), stderr));
    static_cast<void>(std::fflush(stderr));
  } catch (...) {  // no memory for a remark
  }
}

}  // namespace psf::core
