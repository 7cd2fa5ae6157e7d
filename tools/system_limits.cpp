// Limits of memory and of threads that libraries do not survive: they abort, crash or never end.
// Linked into each program; there is nothing to call.
//
// Libraries that OpenImageIO brings along start threads and fill tables before main(), and oneTBB
// has no answer to a thread that cannot be had. So the room for them is looked at before the first
// constructor runs, and whoever asks for a thread, there is one or the program ends with exit code
// 5 and one line.
#include <dlfcn.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <system_error>

#include "core/error.h"
#include "core/unfinished.h"

namespace psf::tools {
namespace {

// Bytes that the constructors of the libraries and their first threads take, and as much again.
constexpr std::size_t kRoom = std::size_t{128} << 20;

const char* program = "psf";

// Takes no memory.
[[noreturn]] void give_up(const char* why) noexcept {
  core::remove_unfinished();
  const auto part = [](const char* text) {
    return iovec{const_cast<char*>(text), std::strlen(text)};
  };
  const std::array<iovec, 4> line = {part(program), part(": "), part(why), part("\n")};
  static_cast<void>(!::writev(STDERR_FILENO, line.data(), static_cast<int>(line.size())));
  ::_exit(static_cast<int>(ErrorCode::limit));
}

// What comes out of a thread or a constructor without being caught.
[[noreturn]] void terminate() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    give_up("out of memory");
  } catch (const std::system_error& error) {
    if (error.code().value() == EAGAIN || error.code().value() == ENOMEM) give_up("out of memory");
  } catch (...) {
  }
  std::abort();
}

void before_constructors(int count, char** arguments, char**) {
  if (count > 0) {
    const char* slash = std::strrchr(arguments[0], '/');
    program = slash != nullptr ? slash + 1 : arguments[0];
  }
  std::set_terminate(terminate);
  void* const room =
      ::mmap(nullptr, kRoom, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (room == MAP_FAILED) {
    give_up(
        "out of memory: the limits of the system leave less than 128 MiB beside the program's own "
        "code; raise them (ulimit -v, ulimit -d)");
  }
  ::munmap(room, kRoom);
}

__attribute__((section(".preinit_array"),
               used)) void (*const kBefore)(int, char**, char**) = before_constructors;

}  // namespace
}  // namespace psf::tools

// In place of the C library's, for all libraries.
extern "C" [[gnu::visibility("default")]] int pthread_create(pthread_t* thread,
                                                             const pthread_attr_t* attributes,
                                                             void* (*start)(void*),
                                                             void* argument) noexcept {
  using Create = int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  static Create* const create =
      reinterpret_cast<Create*>(::dlsym(RTLD_NEXT, "pthread_create"));  // NOLINT: so POSIX has it
  const int error = create(thread, attributes, start, argument);
  if (error == EAGAIN || error == ENOMEM) {
    psf::tools::give_up(
        "cannot start a thread: the limit of processes (ulimit -u) or of memory (ulimit -v) is "
        "reached; raise it, or give --threads 1");
  }
  return error;
}
