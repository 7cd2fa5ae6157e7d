#include "formats/write/frame_writer.h"

#include <array>

#include "formats/layout/crc.h"
#include "formats/layout/head_frame.h"
#include "formats/layout/layout.h"

namespace psf::formats {
namespace {

constexpr std::array<std::byte, kPage> kZeros{};

std::span<const std::byte> zeros(std::uint64_t count) {
  return std::span(kZeros).first(static_cast<std::size_t>(count));
}

// Adds `bytes` to the parts of a frame, and zeros up to the next multiple of `alignment`.
void add_padded(std::vector<std::span<const std::byte>>& parts, std::span<const std::byte> bytes,
                std::size_t alignment) {
  parts.push_back(bytes);
  parts.push_back(zeros(align_up(bytes.size(), alignment) - bytes.size()));
}

}  // namespace

FrameWriter::FrameWriter(File file, const Frame& head, const Prefix& last)
    : file_(std::move(file)),
      uuid_(head.prefix.uuid),
      head_front_(encode_front(head.prefix, head.directory)),
      slot_(head.end()),
      end_(last.offset + last.length),
      sequence_(last.sequence + 1) {}

void FrameWriter::write_start(const Head& head) {
  const std::vector<std::byte> directory = encode_head(head);
  head_front_ =
      front(kHeadType, kRequiredFrame, directory, align_up(kPrefix + directory.size(), kPage));
  Parts parts;
  add_padded(parts, head_front_, kPage);
  write(parts);
  slot_ = end_;
  const std::vector<std::byte> slot = front(kSlotType, 0, {}, kPage);
  parts.clear();
  add_padded(parts, slot, kPage);
  write(parts);
}

ChunkEntry FrameWriter::write_chunk(Chunk chunk, std::span<const EncodedColumn> columns) {
  std::uint64_t place = align_up(kPrefix + kChunkFixed + kColumnEntry * columns.size(), kAlignment);
  for (const EncodedColumn& column : columns) {
    chunk.columns.push_back({static_cast<std::uint16_t>(chunk.columns.size()), column.codec,
                             column.filter, column.crc, place, column.bytes.size()});
    place = align_up(place + column.bytes.size(), kAlignment);
  }
  const std::uint64_t length = align_up(place, kPage);
  const bool of_paths = chunk.table == 0;
  const auto start = front(of_paths ? kChunkType : kTableChunkType, of_paths ? kRequiredFrame : 0,
                           encode_chunk(chunk), length);
  Parts parts;
  add_padded(parts, start, kAlignment);
  for (const EncodedColumn& column : columns) add_padded(parts, column.bytes, kAlignment);
  parts.push_back(zeros(length - place));
  const ChunkEntry entry{end_, length, chunk.first, chunk.count, chunk.pass};
  write(parts);
  return entry;
}

SlotRecord FrameWriter::write_commit(Commit commit, std::span<const ChunkEntry> index,
                                     std::span<const std::byte> resume_state) {
  const std::vector<std::byte> entries = encode_index(index);
  commit.index = {0, entries.size(), crc32(entries)};
  commit.head = {0, head_front_.size(), crc32(head_front_)};
  commit.resume = {0, resume_state.size(), crc32(resume_state)};
  place_sections(commit);
  const std::uint64_t length = commit_length(commit);
  const auto start = front(kCommitType, kRequiredFrame, encode_commit(commit), length);
  Parts parts;
  add_padded(parts, start, kAlignment);
  add_padded(parts, entries, kAlignment);
  add_padded(parts, head_front_, kAlignment);
  parts.push_back(resume_state);
  parts.push_back(zeros(length - commit.resume.offset - commit.resume.length));
  const SlotRecord record{end_, length, sequence_};
  write(parts);
  return record;
}

void FrameWriter::write_slot(std::uint64_t commit_number, const SlotRecord& record) {
  const std::vector<std::byte> bytes = encode_slot_record(record);
  const std::array<std::span<const std::byte>, 1> parts{bytes};
  file_.write_at(slot_ + slot_record_offset(commit_number), parts);
}

std::vector<std::byte> FrameWriter::front(std::uint32_t type, std::uint32_t flags,
                                          std::span<const std::byte> directory,
                                          std::uint64_t length) const {
  return encode_front({uuid_, type, flags, end_, length, sequence_}, directory);
}

void FrameWriter::write(const Parts& parts) {
  file_.write_at(end_, parts);
  for (const auto& part : parts) end_ += part.size();
  ++sequence_;
}

}  // namespace psf::formats
