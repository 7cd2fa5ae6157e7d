#include "core/unfinished.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <new>
#include <utility>

namespace psf::core {
namespace {

// A signal handler can take no lock and free no memory. Whoever takes a name out of its place owns
// it. What finds no place is removed by its destructor alone.
constexpr std::size_t kPlaces = 256;
std::array<std::atomic<char*>, kPlaces> places;
static_assert(std::atomic<char*>::is_always_lock_free, "a signal handler needs lock-free places");

}  // namespace

Unfinished::Unfinished(const std::string& path) : path_(::strdup(path.c_str())) {
  if (path_ == nullptr) throw std::bad_alloc();
  for (std::size_t k = 0; k < kPlaces && !placed_; ++k) {
    char* empty = nullptr;
    placed_ = places[k].compare_exchange_strong(empty, path_);
  }
}

Unfinished::~Unfinished() {
  if (path_ != nullptr && ::unlink(path_) != 0) static_cast<void>(::rmdir(path_));
  keep();
}

void Unfinished::keep() noexcept {
  char* own = std::exchange(path_, nullptr);
  if (own == nullptr) return;
  bool ours = !placed_;
  for (std::size_t k = 0; k < kPlaces && !ours; ++k) {
    char* expected = own;
    ours = places[k].compare_exchange_strong(expected, nullptr);
  }
  if (ours) std::free(own);  // otherwise a signal handler has it, and the program ends
}

void remove_unfinished() noexcept {
  std::array<const char*, kPlaces> folders;
  std::size_t count = 0;
  for (std::atomic<char*>& place : places) {
    const char* path = place.exchange(nullptr);
    if (path != nullptr && ::unlink(path) != 0) folders[count++] = path;
  }
  // The last first: a folder in another was made after it.
  while (count > 0) static_cast<void>(::rmdir(folders[--count]));
}

}  // namespace psf::core
