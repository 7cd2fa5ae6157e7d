// The example of formats/README.md as programs of other versions would write it: what must be read
// and what refused.
#pragma once

#include <string>

namespace psf::test {

// Version 1.1, an optional feature, a metadata key and bytes behind the metadata that version 1.0
// does not know.
void write_golden_minor(const std::string& path);
// Version 2.0.
void write_golden_major(const std::string& path);
// Version 1.0 with a required feature that it does not know.
void write_golden_required(const std::string& path);
// Every integer of the frames' first 64 bytes the other way round, checksums of the bytes as they
// stand: what a program that writes structs makes of it on a big-endian host.
void write_golden_swapped(const std::string& path);

}  // namespace psf::test
