// The ZIP compression of an EXR's chunk.
#pragma once

#include <cstdint>
#include <vector>

namespace psf::film {

// The bytes of a chunk as the file holds them: deflated as OpenEXR's technical introduction has it,
// or as they are where that does not make them fewer. The same bytes for one kind of processor.
[[nodiscard]] std::vector<std::uint8_t> exr_zip(std::vector<std::uint8_t> bytes);

}  // namespace psf::film
