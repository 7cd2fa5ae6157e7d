// Small path-vertex buffers with known values: two passes, every type and encoding, NaN and
// infinity.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/layout/head.h"
#include "formats/write/writer.h"

namespace psf::test {

constexpr std::size_t kGoldenPass = 24;      // records a pass
constexpr std::size_t kGoldenPasses = 2;     // committed
constexpr std::size_t kGoldenCapacity = 16;  // records a chunk, so a pass has two
constexpr std::size_t kGoldenRecords = kGoldenPass * kGoldenPasses;

[[nodiscard]] formats::Head golden_head();
// Stored bytes of records [first, first + count) of a channel, by a formula that needs no
// floating-point library.
[[nodiscard]] std::vector<std::byte> golden_values(std::size_t channel, std::size_t first,
                                                   std::size_t count);
[[nodiscard]] formats::Uuid golden_uuid();

// Closed, two passes.
void write_golden(const std::string& path, formats::Codec codec);
// Two passes, not closed, and a chunk behind the last commit.
void write_golden_tail(const std::string& path);

// The example of formats/README.md: three records of `position` and `flags`, closed.
void write_example(const std::string& path);
// "00001000  89 50 56 42 ..." a row of 16 bytes, rows of zeros left out.
[[nodiscard]] std::string hex_dump(const std::string& path);

}  // namespace psf::test
