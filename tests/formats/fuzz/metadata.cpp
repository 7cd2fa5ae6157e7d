// Fuzzes metadata and the directories of all frames.
#include "formats/layout/metadata.h"

#include <algorithm>
#include <string>

#include "core/error.h"
#include "formats/layout/chunk.h"
#include "formats/layout/commit.h"
#include "formats/layout/frame.h"
#include "formats/layout/head_frame.h"
#include "formats/layout/layout.h"
#include "formats/layout/slot.h"
#include "targets.h"

namespace psf::fuzz {
namespace {

std::string text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void metadata(Bytes bytes) {
  const formats::Metadata parsed = formats::parse_metadata(text_of(bytes));
  const std::string written = formats::to_json(parsed);
  demand(formats::to_json(formats::parse_metadata(written)) == written,
         "metadata survive being written and read");
}

void head(Bytes bytes) {
  const formats::Head decoded = formats::decode_head(bytes);
  formats::validate(decoded);
  const formats::Head again = formats::decode_head(formats::encode_head(decoded));
  demand(again.channels == decoded.channels && again.metadata == decoded.metadata &&
             again.chunk_capacity == decoded.chunk_capacity,
         "a head survives being written and read");
}

formats::Frame frame(std::uint32_t type, Bytes directory) {
  formats::Frame frame;
  frame.prefix = {{}, type, formats::kRequiredFrame, 16 * formats::kPage, 16 * formats::kPage, 9};
  frame.directory.assign(directory.begin(), directory.end());
  return frame;
}

void chunk(Bytes bytes) {
  formats::Head two;
  two.channels = {{"position", formats::Type::f32, 3}, {"flags", formats::Type::u8, 1}};
  const formats::Frame front = frame(formats::kChunkType, bytes);
  const formats::Chunk decoded = formats::decode_chunk(front, two);
  for (const formats::Column& column : decoded.columns) {
    demand(column.offset <= front.prefix.length &&
               column.stored <= front.prefix.length - column.offset,
           "a column lies within its frame");
  }
  demand(decoded.count <= two.chunk_capacity, "a chunk keeps the capacity");
}

void commit(Bytes bytes) {
  const formats::Frame front = frame(formats::kCommitType, bytes);
  const formats::Commit decoded = formats::decode_commit(front, 2);
  for (const formats::Section& section : {decoded.index, decoded.head, decoded.resume}) {
    demand(section.offset <= front.prefix.length &&
               section.length <= front.prefix.length - section.offset,
           "a section lies within its frame");
  }
}

void index(Bytes bytes) {
  const auto entries = formats::decode_index(bytes);
  const auto again = formats::encode_index(entries);
  demand(std::equal(again.begin(), again.end(), bytes.begin()),
         "an index survives being read and written");
  if (bytes.size() < formats::kSlotRecord) return;
  const auto record = formats::decode_slot_record(bytes.first(formats::kSlotRecord));
  if (record) static_cast<void>(formats::encode_slot_record(*record));
}

}  // namespace

void fuzz_metadata(Bytes bytes) {
  if (bytes.empty()) return;
  const Bytes rest = bytes.subspan(1);
  try {
    switch (std::to_integer<char>(bytes[0])) {
      case 'h':
        return head(rest);
      case 'c':
        return chunk(rest);
      case 'm':
        return commit(rest);
      case 'i':
        return index(rest);
      default:
        return metadata(rest);
    }
  } catch (const Error& error) {
    const std::string text = error.what();
    demand(error.code() == ErrorCode::bad_input || error.code() == ErrorCode::limit,
           "bad bytes are bad input: " + text);
    demand(text.find('\n') == std::string::npos, "an error is one line: " + text);
  }
}

}  // namespace psf::fuzz
