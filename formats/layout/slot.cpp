#include "formats/layout/slot.h"

#include <algorithm>
#include <array>

#include "formats/layout/bytes.h"
#include "formats/layout/crc.h"
#include "formats/layout/layout.h"

namespace psf::formats {

std::vector<std::byte> encode_slot_record(const SlotRecord& record) {
  ByteWriter out;
  out.put(record.offset);
  out.put(record.length);
  out.put(record.sequence);
  out.put_zeros(4);
  out.put(crc32(out.bytes()));
  return out.take();
}

std::optional<SlotRecord> decode_slot_record(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  SlotRecord record;
  record.offset = in.get<std::uint64_t>();
  record.length = in.get<std::uint64_t>();
  record.sequence = in.get<std::uint64_t>();
  in.skip(4);
  if (!crc_matches(crc32(bytes.first(kSlotRecord - 4)), in.get<std::uint32_t>())) {
    return std::nullopt;
  }
  return record;
}

std::size_t slot_record_offset(std::uint64_t commit_number) {
  return commit_number % 2 == 1 ? kSlotFirst : kSlotSecond;
}

namespace {

// Nothing where no slot can be read.
std::optional<std::array<std::byte, kPage>> read_page(const File& file, std::uint64_t file_size,
                                                      std::uint64_t offset, const Uuid& uuid) {
  const FrameResult slot = read_frame(file, file_size, offset, &uuid);
  if (slot.state != FrameState::whole || slot.frame.prefix.type != kSlotType) return std::nullopt;
  std::array<std::byte, kPage> page;
  file.read_at(offset, page);
  return page;
}

}  // namespace

std::vector<SlotRecord> read_slot(const File& file, std::uint64_t file_size, std::uint64_t offset,
                                  const Uuid& uuid) {
  std::vector<SlotRecord> records;
  const auto page = read_page(file, file_size, offset, uuid);
  if (!page) return records;
  for (const std::size_t place : {kSlotFirst, kSlotSecond}) {
    const auto record = decode_slot_record(std::span(*page).subspan(place, kSlotRecord));
    if (record) records.push_back(*record);
  }
  std::sort(records.begin(), records.end(),
            [](const SlotRecord& a, const SlotRecord& b) { return a.sequence > b.sequence; });
  return records;
}

bool is_unwritten_slot(const File& file, std::uint64_t file_size, std::uint64_t offset,
                       const Uuid& uuid) {
  const auto page = read_page(file, file_size, offset, uuid);
  return page && std::all_of(page->begin() + kSlotFirst, page->end(),
                             [](std::byte value) { return value == std::byte{0}; });
}

}  // namespace psf::formats
