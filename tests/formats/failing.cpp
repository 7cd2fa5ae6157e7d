#include "failing.h"

#include <fcntl.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cerrno>

namespace psf::test {
namespace {

bool fails(const char* name) {
  Calls& state = calls();
  ++state.changes;
  if (state.left < 0 || state.left-- > 0) return false;
  state.failed = name;
  return true;
}

}  // namespace

Calls& calls() {
  static Calls instance;
  return instance;
}

}  // namespace psf::test

using psf::test::calls;
using psf::test::fails;

extern "C" {
ssize_t __real_pwritev(int file, const iovec* parts, int count, off_t offset);
ssize_t __real_pread(int file, void* out, size_t size, off_t offset);
int __real_fdatasync(int file);
int __real_fsync(int file);
int __real_rename(const char* from, const char* to);
int __real_close(int file);

ssize_t __wrap_pwritev(int file, const iovec* parts, int count, off_t offset);
ssize_t __wrap_pread(int file, void* out, size_t size, off_t offset);
int __wrap_fdatasync(int file);
int __wrap_fsync(int file);
int __wrap_rename(const char* from, const char* to);
int __wrap_close(int file);

ssize_t __wrap_pwritev(int file, const iovec* parts, int count, off_t offset) {
  if (!fails("pwritev")) return __real_pwritev(file, parts, count, offset);
  if (calls().tear) {
    static_cast<void>(::pwrite(file, parts[0].iov_base, parts[0].iov_len / 2, offset));
  }
  errno = ENOSPC;
  return -1;
}

ssize_t __wrap_pread(int file, void* out, size_t size, off_t offset) {
  ++calls().reads;
  const ssize_t got = __real_pread(file, out, size, offset);
  if (got > 0) calls().bytes_read += static_cast<std::uint64_t>(got);
  return got;
}

int __wrap_fdatasync(int file) {
  if (!fails("fdatasync")) return calls().skip_sync ? 0 : __real_fdatasync(file);
  errno = EIO;
  return -1;
}

int __wrap_fsync(int file) {
  if (!fails("fsync")) return calls().skip_sync ? 0 : __real_fsync(file);
  errno = EIO;
  return -1;
}

int __wrap_rename(const char* from, const char* to) {
  if (!fails("rename")) return __real_rename(from, to);
  errno = EROFS;
  return -1;
}

// A close that fails has closed all the same.
int __wrap_close(int file) {
  const bool writes = (::fcntl(file, F_GETFL) & O_ACCMODE) == O_RDWR;
  const bool failing = writes && fails("close");
  const int result = __real_close(file);
  if (!failing) return result;
  errno = EIO;
  return -1;
}
}
