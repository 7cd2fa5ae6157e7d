// Path-vertex buffers whose every value is a formula of the record's number, which is a channel
// itself: what comes out of a damaged, resumed or joined file can be judged record by record.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/read/reader.h"
#include "formats/write/writer.h"

namespace psf::test {

constexpr std::size_t kNumberedPass = 40;      // records a pass
constexpr std::size_t kNumberedCapacity = 16;  // records a chunk, so a pass has three

// Channel 0 is `number`, u64.
[[nodiscard]] formats::Head numbered_head();
// Stored values of a channel of the records with these numbers.
[[nodiscard]] std::vector<std::byte> numbered_values(std::size_t channel,
                                                     std::span<const std::uint64_t> numbers);
// first, first + 1, ...
[[nodiscard]] std::vector<std::uint64_t> numbers_from(std::uint64_t first, std::size_t count);

void append_numbered(formats::Writer& writer, std::uint64_t first, std::size_t count);
// The next passes, up to `last` in the file, each with its resume state.
void write_numbered(formats::Writer& writer, std::uint64_t last);
// "pass 7"
[[nodiscard]] std::string numbered_state(std::uint64_t passes);
// A whole file, closed, written without waiting for the disk.
void write_numbered_file(const std::string& path, formats::Codec codec, std::uint64_t passes);

// The channel `number` of all records.
[[nodiscard]] std::vector<std::uint64_t> numbers_of(const formats::Reader& reader);
// Columns in which a value is not that of its record's number.
[[nodiscard]] std::size_t wrong_columns(const formats::Reader& reader);
// Whether the file holds exactly the records 0 to passes * kNumberedPass, and in the right passes.
[[nodiscard]] bool holds_passes(const formats::Reader& reader, std::uint64_t passes);

}  // namespace psf::test
