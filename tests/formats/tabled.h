// Path-vertex buffers with tables whose every value is a formula of the record's number, which is a
// channel itself: numbered.h, with two tables beside the paths.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/read/reader.h"
#include "formats/write/writer.h"

namespace psf::test {

// Records of a table in a pass: `marks` has some in every pass, `rare` in every third.
[[nodiscard]] std::size_t tabled_count(std::size_t table, std::uint64_t pass);

// numbered_head() and the tables `marks` and `rare`; channel 0 of each is `number`, u64: pass x 1000
// and the place in the pass.
[[nodiscard]] formats::Head tabled_head();
[[nodiscard]] std::vector<std::byte> tabled_values(std::size_t table, std::size_t channel,
                                                   const std::vector<std::uint64_t>& numbers);

// The records of the next pass, of the paths and of both tables in turns, without a commit.
void append_tabled(formats::Writer& writer);
// The next passes, up to `last` in the file, each with its resume state.
void write_tabled(formats::Writer& writer, std::uint64_t last);
// A whole file, closed, written without waiting for the disk.
void write_tabled_file(const std::string& path, formats::Codec codec, std::uint64_t passes);

[[nodiscard]] std::vector<std::uint64_t> numbers_of(const formats::TableReader& table);
// Columns of the tables in which a value is not that of its record's number.
[[nodiscard]] std::size_t wrong_table_columns(const formats::Reader& reader);
// Whether the tables hold exactly the records of so many passes, and in the right ones.
[[nodiscard]] bool holds_tables(const formats::Reader& reader, std::uint64_t passes);

}  // namespace psf::test
