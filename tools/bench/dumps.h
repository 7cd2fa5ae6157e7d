// The path-vertex buffers that are measured: made up, copied from a file in one codec, or mere
// holes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "formats/reader.h"
#include "formats/writer.h"

namespace psf::bench {

// A room seen by a pinhole camera in scanline order, noise in the colours: the channels that
// psf-render writes, of about `records` records.
void write_synthetic(const std::string& path, std::size_t records, formats::Codec codec);

// The first chunks of `from`, up to about `records` records, passes kept, in another codec.
void write_copy(const formats::Reader& from, const std::string& path, std::size_t records,
                formats::Codec codec);

// A closed file of 50,000 chunks and more than 200 GB, of which only head, index and commit take
// room on the disk. Throws Error{io} where the file system has no holes that large.
void write_sparse(const std::string& path);

}  // namespace psf::bench
