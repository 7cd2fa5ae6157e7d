// A channel of a table of the dump, of the type that formats/README.md gives it.
#pragma once

#include <cstddef>
#include <string_view>

#include "formats/read/reader.h"

namespace psf::run {

// Its place in the table. Floats of any width are taken, and unit vectors as they may be stored;
// integers only as the format has them. Throws Error{bad_input} that names the file, the table, the
// channel and what needs it where it is missing or has another type.
[[nodiscard]] std::size_t table_channel(const formats::Reader& reader,
                                        const formats::TableReader& table, std::string_view name,
                                        formats::Type type, std::size_t components,
                                        std::string_view wanted_by);

}  // namespace psf::run
