#include "formats/layout/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"

namespace psf::formats {
namespace {

constexpr int kLockAttempts = 10;

const char* remedy(int error) {
  switch (error) {
    case ENOENT:
      return "; check the name and that the folder exists";
    case EACCES:
    case EPERM:
    case EROFS:
      return "; check the permissions or choose another folder";
    case ENOSPC:
    case EDQUOT:
      return "; free some space or choose another disk";
    case EFBIG:
      return "; raise the limit on file sizes (ulimit -f) or choose another disk";
    case EMFILE:
    case ENFILE:
      return "; raise the limit on open files (ulimit -n)";
    default:
      return "";
  }
}

[[noreturn]] void throw_errno(const std::string& path, const char* action) {
  const int error = errno;
  throw Error(ErrorCode::io, fmt::format("{}: cannot {}: {}{}", path, action, std::strerror(error),
                                         remedy(error)));
}

}  // namespace

void File::fail(const char* action) const {
  throw_errno(path_, action);
}

File File::open(const std::string& path) {
  // Without O_NONBLOCK, opening a named pipe would wait for a writer.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) throw_errno(path, "open");
  File file(path, descriptor);
  file.check_regular();
  return file;
}

File File::create(const std::string& path) {
  // Emptied only once it is locked: another process may be writing it.
  File file = open_locked(path, O_CREAT | O_NOFOLLOW, "create");
  file.truncate(0);
  return file;
}

File File::update(const std::string& path) {
  File file = open_locked(path, O_NONBLOCK, "open");
  file.check_regular();
  return file;
}

File File::open_locked(const std::string& path, int flags, const char* action) {
  for (int attempt = 0;;) {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CLOEXEC | flags, 0666);
    if (descriptor < 0) throw_errno(path, action);
    File file(path, descriptor);
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
      // Its writer may have given it another name before we had the lock.
      if (file.is_named()) return file;
      continue;
    }
    // is_being_written() of some other process holds the lock for a moment.
    if (++attempt == kLockAttempts) {
      throw Error(ErrorCode::io,
                  fmt::format("{}: another process is writing it; wait for it or choose another "
                              "name",
                              path));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

bool File::is_being_written(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return false;
  const File file(path, descriptor);
  return ::flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

void File::check_regular() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) fail("open");
  if (!S_ISREG(status.st_mode)) {
    throw Error(ErrorCode::io,
                fmt::format("{}: not a regular file; give the name of a .pvb file", path_));
  }
}

bool File::is_named() const {
  struct stat named {};
  struct stat own {};
  if (::fstat(descriptor_, &own) != 0) fail("read");
  return ::stat(path_.c_str(), &named) == 0 && named.st_dev == own.st_dev &&
         named.st_ino == own.st_ino;
}

File::File(File&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

File& File::operator=(File&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

File::~File() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::uint64_t File::size() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) fail("read");
  return static_cast<std::uint64_t>(status.st_size);
}

void File::read_at(std::uint64_t offset, std::span<std::byte> out) const {
  while (!out.empty()) {
    const ssize_t got = ::pread(descriptor_, out.data(), out.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail("read");
    if (got == 0) {
      throw Error(ErrorCode::io,
                  fmt::format("{}: ends at byte {}: it was cut while being read", path_, offset));
    }
    offset += static_cast<std::uint64_t>(got);
    out = out.subspan(static_cast<std::size_t>(got));
  }
}

void File::write_at(std::uint64_t offset, std::span<const std::span<const std::byte>> parts) {
  std::array<iovec, 1024> list;
  std::size_t count = 0;
  for (const std::span<const std::byte> part : parts) {
    if (part.empty()) continue;
    // writev's interface has no const; it does not write through the pointer.
    list.at(count++) = {const_cast<std::byte*>(part.data()), part.size()};
  }
  std::size_t first = 0;
  while (first < count) {
    const ssize_t put = ::pwritev(descriptor_, &list.at(first), static_cast<int>(count - first),
                                  static_cast<off_t>(offset));
    if (put < 0 && errno == EINTR) continue;
    if (put == 0) errno = ENOSPC;
    if (put <= 0) fail("write");
    offset += static_cast<std::uint64_t>(put);
    auto left = static_cast<std::size_t>(put);
    while (first < count && left >= list.at(first).iov_len) left -= list.at(first++).iov_len;
    if (left > 0) {
      list.at(first).iov_base = static_cast<std::byte*>(list.at(first).iov_base) + left;
      list.at(first).iov_len -= left;
    }
  }
}

void File::sync() {
  if (::fdatasync(descriptor_) != 0) fail("sync");
}

void File::truncate(std::uint64_t size) {
  if (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0) fail("write");
}

void File::flush() {
  // Closing a second descriptor tells what closing the only one would: with it the lock would end.
  const int copy = ::fcntl(descriptor_, F_DUPFD_CLOEXEC, 0);
  if (copy < 0 || ::close(copy) != 0) fail("write");
}

void File::close() {
  if (::close(std::exchange(descriptor_, -1)) != 0) fail("write");
}

void rename_file(const std::string& from, const std::string& to, bool sync) {
  if (std::rename(from.c_str(), to.c_str()) != 0) throw_errno(to, "create");
  if (!sync) return;
  const std::string folder = (std::filesystem::path(to).parent_path() / ".").string();
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) throw_errno(folder, "sync");
  const int result = ::fsync(descriptor);
  const int error = errno;
  ::close(descriptor);
  errno = error;
  // Some network file systems cannot sync a folder; the file itself is safe.
  if (result != 0 && errno != EINVAL) throw_errno(folder, "sync");
}

}  // namespace psf::formats
