// Makes the path-vertex buffers that are measured: synthetic, copied from a file in one codec, or
// sparse.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "formats/read/reader.h"
#include "formats/write/writer.h"

namespace psf::bench {

// Writes about `records` records of a room seen by a pinhole camera, in scanline order, with noise
// in the colours and the channels that psf-render writes.
void write_synthetic(const std::string& path, std::size_t records, formats::Codec codec);

// Copies the first chunks of `from`, up to about `records` records, in another codec, with the same
// passes.
void write_copy(const formats::Reader& from, const std::string& path, std::size_t records,
                formats::Codec codec);

// Writes a closed file of 50,000 chunks and more than 200 GB, of which only head, index and commit
// take space on the disk. Throws Error{io} where the file system cannot have such large holes.
void write_sparse(const std::string& path);

}  // namespace psf::bench
