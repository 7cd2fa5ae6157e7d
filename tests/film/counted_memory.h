// What this program and the libraries that it loads allocate through operator new.
#pragma once

#include <cstdint>

namespace psf::tests {

[[nodiscard]] std::uint64_t allocated_bytes();  // ever

}  // namespace psf::tests
