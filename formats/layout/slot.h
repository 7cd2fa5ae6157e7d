// The frame SLOT: a page with two records, written in turn, of the place of the last commit. They
// are hints.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "formats/layout/file.h"
#include "formats/layout/frame.h"

namespace psf::formats {

struct SlotRecord {
  std::uint64_t offset = 0, length = 0, sequence = 0;  // those of the frame CMIT
};

[[nodiscard]] std::vector<std::byte> encode_slot_record(const SlotRecord& record);
// The record, or nothing where the checksum is wrong, as in a record that was never written.
[[nodiscard]] std::optional<SlotRecord> decode_slot_record(std::span<const std::byte> bytes);

// The place of a commit's record in the page.
[[nodiscard]] std::size_t slot_record_offset(std::uint64_t commit_number);

// The readable records, the newest first. `offset`: place of the frame SLOT, which follows HEAD.
[[nodiscard]] std::vector<SlotRecord> read_slot(const File& file, std::uint64_t file_size,
                                                std::uint64_t offset, const Uuid& uuid);

// Whether no record was ever written to the slot.
[[nodiscard]] bool is_unwritten_slot(const File& file, std::uint64_t file_size,
                                     std::uint64_t offset, const Uuid& uuid);

}  // namespace psf::formats
