// Reads all that a file holds, in every way that the reader offers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/error.h"
#include "formats/read/reader.h"

namespace psf::fuzz {

// The bytes of one column; none where the reader refused it, or where it is too long for a run.
struct ColumnBytes {
  bool readable = false;
  std::vector<std::byte> bytes;
};

struct Contents {
  bool complete = true;  // no column was refused, of the paths or of a table
  std::uint64_t records = 0;
  std::vector<std::vector<ColumnBytes>> columns;  // of the paths, by channel, by chunk
  std::vector<std::byte> resume_state;
};

// Throws Broken where two ways to read differ or totals do not add up.
[[nodiscard]] Contents read_everything(const formats::Reader& reader);

// Throws Broken where an Error is not what errors of a file must be: bad input or a limit, one line
// that begins with the name of the file.
void demand_good_error(const Error& error, const std::string& path);

}  // namespace psf::fuzz
