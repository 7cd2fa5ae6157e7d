// Mutations that know the pages of a path-vertex buffer, and mend its checksums afterwards.
#pragma once

#include <cstddef>
#include <cstdint>

namespace psf::fuzz {

// In place, at most `most` bytes; returns the new size. `any` is libFuzzer's own mutation.
[[nodiscard]] std::size_t mutate_file(std::uint8_t* data, std::size_t size, std::size_t most,
                                      unsigned seed,
                                      std::size_t (*any)(std::uint8_t*, std::size_t, std::size_t));

}  // namespace psf::fuzz
