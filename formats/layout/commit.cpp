#include "formats/layout/commit.h"

#include <fmt/format.h>

#include "core/error.h"
#include "formats/layout/bytes.h"
#include "formats/layout/crc.h"
#include "formats/layout/layout.h"

namespace psf::formats {
namespace {

void put(ByteWriter& out, const Section& section) {
  out.put(section.offset);
  out.put(section.length);
  out.put(section.crc);
  out.put_zeros(4);
}

Section get(ByteReader& in) {
  Section section;
  section.offset = in.get<std::uint64_t>();
  section.length = in.get<std::uint64_t>();
  section.crc = in.get<std::uint32_t>();
  in.skip(4);
  return section;
}

void check_section(const Frame& frame, const Section& section, std::uint64_t most,
                   const char* name) {
  if (section.length > most || section.offset < kPrefix + frame.directory.size() ||
      section.offset % kAlignment != 0 || section.offset > frame.prefix.length ||
      section.length > frame.prefix.length - section.offset) {
    refuse(fmt::format("impossible place or length of its {}", name));
  }
}

void put(ByteWriter& out, const ChunkEntry& entry) {
  out.put(entry.offset);
  out.put(entry.length);
  out.put(entry.first);
  out.put(entry.count);
  out.put(entry.pass);
}

ChunkEntry get_entry(ByteReader& in) {
  ChunkEntry entry;
  entry.offset = in.get<std::uint64_t>();
  entry.length = in.get<std::uint64_t>();
  entry.first = in.get<std::uint64_t>();
  entry.count = in.get<std::uint32_t>();
  entry.pass = in.get<std::uint32_t>();
  return entry;
}

void put_tables(ByteWriter& out, std::span<const TableTotals> tables) {
  out.put(static_cast<std::uint32_t>(tables.size()));
  out.put_zeros(4);
  for (const TableTotals& table : tables) {
    out.put(table.records);
    out.put(table.chunks);
    out.put(table.first_chunk);
    out.put_zeros(8);
  }
  for (const TableTotals& table : tables) {
    for (const ChunkEntry& entry : table.index) put(out, entry);
  }
}

// `most`: chunks that there can be before the commit.
std::vector<TableTotals> get_tables(ByteReader& in, std::size_t count, std::uint64_t most) {
  std::vector<TableTotals> tables(count);
  if (in.rest().empty()) return tables;  // a program of version 1.0 has copied the paths
  const std::size_t told = in.get<std::uint32_t>();
  if (told != count) refuse(fmt::format("it is of {} tables; there are {}", told, count));
  in.skip(4);
  for (TableTotals& table : tables) {
    table.records = in.get<std::uint64_t>();
    table.chunks = in.get<std::uint64_t>();
    table.first_chunk = in.get<std::uint64_t>();
    in.skip(8);
  }
  for (TableTotals& table : tables) {
    if (table.chunks > most || table.first_chunk > table.chunks ||
        table.chunks - table.first_chunk > in.rest().size() / kIndexEntry) {
      refuse("the totals and the indices of its tables do not fit together");
    }
    for (std::uint64_t k = table.first_chunk; k < table.chunks; ++k) {
      table.index.push_back(get_entry(in));
    }
  }
  return tables;
}

}  // namespace

std::vector<std::byte> encode_commit(const Commit& commit) {
  ByteWriter out;
  out.put(commit.flags);
  out.put_zeros(4);
  out.put(commit.number);
  out.put(commit.records);
  out.put(commit.chunks);
  out.put(commit.passes);
  out.put(commit.previous);
  out.put(commit.base);
  out.put(commit.first_chunk);
  out.put(commit.foreign_required);
  put(out, commit.index);
  put(out, commit.head);
  put(out, commit.resume);
  out.put_zeros(kCommitFixed - out.bytes().size());
  if (!commit.tables.empty()) put_tables(out, commit.tables);
  return out.take();
}

std::size_t commit_directory(const Commit& commit) {
  if (commit.tables.empty()) return kCommitFixed;
  std::size_t size = kCommitFixed + 8 + kTableTotals * commit.tables.size();
  for (const TableTotals& table : commit.tables) size += kIndexEntry * table.index.size();
  return size;
}

Commit decode_commit(const Frame& frame, std::size_t tables) {
  if (frame.prefix.type != kCommitType) {
    refuse(fmt::format("a frame {} stands in its place", type_name(frame.prefix.type)));
  }
  ByteReader in(std::span(frame.directory));
  Commit commit;
  commit.flags = in.get<std::uint32_t>();
  in.skip(4);
  commit.number = in.get<std::uint64_t>();
  commit.records = in.get<std::uint64_t>();
  commit.chunks = in.get<std::uint64_t>();
  commit.passes = in.get<std::uint64_t>();
  commit.previous = in.get<std::uint64_t>();
  commit.base = in.get<std::uint64_t>();
  commit.first_chunk = in.get<std::uint64_t>();
  commit.foreign_required = in.get<std::uint64_t>();
  commit.index = get(in);
  commit.head = get(in);
  commit.resume = get(in);
  in.skip(kCommitFixed - 144);
  check_section(frame, commit.index, frame.prefix.length, "index");
  check_section(frame, commit.head, kPrefix + kMaxDirectory, "copy of HEAD");
  check_section(frame, commit.resume, kMaxResumeState, "resume state");
  if (commit.index.length % kIndexEntry != 0 || commit.first_chunk > commit.chunks ||
      commit.index.length / kIndexEntry != commit.chunks - commit.first_chunk ||
      commit.chunks > frame.prefix.offset / kPage ||  // each takes a page at least
      (commit.first_chunk > 0 && commit.base == 0) || commit.base >= frame.prefix.offset ||
      commit.previous >= frame.prefix.offset || commit.number == 0) {
    refuse("its totals and its index do not fit together");
  }
  if (tables > 0) commit.tables = get_tables(in, tables, frame.prefix.offset / kPage);
  return commit;
}

std::vector<std::byte> read_section(const File& file, const Frame& frame, const Section& section) {
  std::vector<std::byte> bytes(static_cast<std::size_t>(section.length));
  file.read_at(frame.prefix.offset + section.offset, bytes);
  if (!crc_matches(crc32(bytes), section.crc)) refuse("the checksum of a section of it is wrong");
  return bytes;
}

std::vector<std::byte> encode_index(std::span<const ChunkEntry> entries) {
  ByteWriter out;
  for (const ChunkEntry& entry : entries) put(out, entry);
  return out.take();
}

std::vector<ChunkEntry> decode_index(std::span<const std::byte> bytes) {
  std::vector<ChunkEntry> entries(bytes.size() / kIndexEntry);
  ByteReader in(bytes);
  for (ChunkEntry& entry : entries) entry = get_entry(in);
  return entries;
}

void place_sections(Commit& commit) {
  std::uint64_t place = align_up(kPrefix + commit_directory(commit), kAlignment);
  for (Section* section : {&commit.index, &commit.head, &commit.resume}) {
    section->offset = place;
    place = align_up(place + section->length, kAlignment);
  }
}

std::uint64_t commit_length(const Commit& commit) {
  return align_up(commit.resume.offset + commit.resume.length, kPage);
}

}  // namespace psf::formats
