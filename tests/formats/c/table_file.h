// Files with tables, through the C header: golden paths, and golden values by table and record.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "c_file.h"

namespace psf::test {

// `vertices` with all golden channels, and `photons`, which most passes have none of. They are those
// of ../python/golden.py.
struct GoldenTable {
  std::string name;
  std::vector<std::size_t> channels;  // numbers of golden channels
  std::uint32_t capacity;
};
[[nodiscard]] const std::vector<GoldenTable>& golden_tables();
[[nodiscard]] std::vector<std::vector<pvb_channel>> table_channels();  // of each
// For pvb_create_with(); `channels` are table_channels().
[[nodiscard]] std::vector<pvb_table> c_tables(
    const std::vector<std::vector<pvb_channel>>& channels);

// Records of a table in a pass, and in all passes before it.
[[nodiscard]] std::size_t table_records(std::size_t table, std::size_t pass);
[[nodiscard]] std::size_t records_before(std::size_t table, std::size_t pass);
[[nodiscard]] Bytes table_values(std::size_t table, std::size_t channel, std::size_t first,
                                 std::size_t count);

// The golden head and uuid, not synced.
[[nodiscard]] pvb_file* create_tables(const std::string& path);
[[nodiscard]] pvb_file* resume_tables(const std::string& path);
// A golden pass of paths and tables, and its resume state "resume N".
int append_tables(pvb_file* file, std::size_t pass);
int write_tables_pass(pvb_file* file, std::size_t pass);
// A file of so many passes.
void write_tables(const std::string& path, std::size_t passes, bool close = true);

// Records of a table's channel; empty and an error where it cannot.
[[nodiscard]] Bytes c_read_from(pvb_file* file, std::size_t table, std::size_t channel,
                                std::uint64_t first, std::size_t count);
// Empty where the file holds these passes and nothing else, or what is wrong.
[[nodiscard]] std::string table_faults(const std::string& path, std::size_t passes);
// What ../read_pvb.py and `../python/pvb_tool.py dump` print of it.
[[nodiscard]] std::string tables_dump(std::size_t passes);

}  // namespace psf::test
