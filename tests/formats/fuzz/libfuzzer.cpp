// libFuzzer's side of one target: PSF_FUZZ_TARGET is its function, PSF_FUZZ_FILES says that it
// takes whole files.
#include <tbb/global_control.h>

#include <cstddef>
#include <cstdint>
#include <span>

#include "mutate.h"
#include "targets.h"

// Runs are short: a small quarantine stays in the cache, and a stack a fault is enough.
extern "C" const char* __asan_default_options();  // NOLINT: the sanitizer's name
extern "C" const char* __asan_default_options() {
  return "malloc_context_size=4:quarantine_size_mb=4:thread_local_quarantine_size_kb=256";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Other threads would wake for columns of a few bytes, and make runs differ.
  static const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  psf::fuzz::PSF_FUZZ_TARGET(std::as_bytes(std::span(data, size)));
  return 0;
}

#ifdef PSF_FUZZ_FILES
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  return psf::fuzz::mutate_file(data, size, most, seed, LLVMFuzzerMutate);
}
#endif
